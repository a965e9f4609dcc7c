// The port, with a table for the robot. No test waits for a time that it could compute: it turns the server
// until what it expects is there.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>

#include "robot/igtl/navigation_server.hpp"
#include "tests/robot/igtl/scripted_robot.hpp"
#include "tests/robot/igtl/test_client.hpp"

namespace biopsy::igtl {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
constexpr auto kPatience = 10s;  // for what takes milliseconds

struct TableRobot : RobotLink {
  RobotView now;
  std::vector<Wish> told;  // newest last, without repetitions
  TableRobot() {
    now.heard = now.console = now.measured = true;
    now.mode = Mode::Safe;
  }
  RobotView view(std::int64_t) override { return now; }
  void tell(const Wish& wish, std::int64_t) override {
    if (told.empty() || told.back().stop != wish.stop || told.back().motion != wish.motion ||
        told.back().proposal != wish.proposal || told.back().patient_motion != wish.patient_motion)
      told.push_back(wish);
  }
};

struct Bench {
  TableRobot robot;
  std::unique_ptr<NavigationServer> server;

  explicit Bench(ServerSettings settings = {}, const std::filesystem::path& images = {},
                 Dialect dialect = Dialect::Of2013) {
    settings.port = 0;
    server = std::make_unique<NavigationServer>(settings, dialect, images, robot);
  }
  std::uint16_t port() const { return server->port(); }
  // Turns until the client has so many answers, or was closed.
  Script answers(TestClient& client, std::size_t count) {
    Script all;
    for (const auto until = Clock::now() + kPatience; all.size() < count && Clock::now() < until;) {
      server->turn(1ms);
      for (std::string& one : client.came()) all.push_back(std::move(one));
      if (!all.empty() && all.back() == "closed") break;
    }
    return all;
  }
  template <class Condition>
  bool turn_until(const Condition& holds) {
    for (const auto until = Clock::now() + kPatience; !holds() && Clock::now() < until;) server->turn(1ms);
    return holds();
  }
  Script command(TestClient& client, const std::string& text, std::size_t answers_expected) {
    client.send({"CMD_1", Text{text}});
    return answers(client, answers_expected);
  }
  void move(TestClient& client) {
    command(client, "START_UP", 3);
    command(client, "CALIBRATION", 2);
    client.send({"CLB_1", Transform{}});
    answers(client, 2);
    command(client, "TARGETING", 3);
    Transform target;
    target.columns[11] = 3.5F;
    client.send({"TGT_1", target});
    ASSERT_EQ(answers(client, 1), (Script{"TRANSFORM ACK_1"}));
    robot.now.answered = 1;
    robot.now.planned = robot.now.confirmed = true;
    robot.now.steps = 1;
    ASSERT_EQ(answers(client, 2), (Script{"STATUS TARGET 1", "TRANSFORM TARGET"}));
    robot.now.mode = Mode::Armed;
    ASSERT_EQ(command(client, "MOVE_TO_TARGET", 3).size(), 3U);
    robot.now.mode = Mode::Active;
    ASSERT_TRUE(robot.told.back().motion);
  }
};

}  // namespace biopsy::igtl
