// A navigation program and a robot for the protocol's tests. The robot is a table of what it says; neither
// supervisor nor console stands behind it. Expectations are the rows of the protocol's table.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robot/igtl/protocol.hpp"

namespace biopsy::igtl {

// "STRING ACK_1 START_UP", "STATUS TARGET 10", "TRANSFORM CURRENT_POSITION": what a client's script compares.
inline std::string brief(const Message& message) {
  if (const auto* text = std::get_if<Text>(&message.body))
    return "STRING " + message.device + " " + text->text;
  if (const auto* status = std::get_if<Status>(&message.body)) {
    const bool current = message.device == "CURRENT_STATUS";
    return fmt::format("STATUS {} {}{}", message.device, static_cast<int>(status->code),
                       current ? " " + status->error_name : "");
  }
  if (std::holds_alternative<Transform>(message.body)) return "TRANSFORM " + message.device;
  return "another type";
}

using Script = std::vector<std::string>;

struct ScriptedRobot {
  RobotProtocol protocol;
  RobotView robot;
  std::int64_t now_us = 0;
  std::vector<Message> last;  // that came from the last call
  int queries = 0;

  explicit ScriptedRobot(Dialect dialect) : protocol(dialect) {
    robot.heard = robot.console = robot.measured = true;
    robot.mode = Mode::Safe;
  }

  Script answers(std::vector<Message> messages) {
    last = std::move(messages);
    Script brief_ones;
    for (const Message& message : last) brief_ones.push_back(brief(message));
    return brief_ones;
  }
  Script send(Message message) { return answers(protocol.receive(message, robot, ++now_us)); }
  // STRING(CMD_n, command), with n = 1 in every script: the number is only echoed.
  Script command(const std::string& command) { return send({"CMD_1", Text{command}}); }
  Script calibrate(const Transform& transform = {}) { return send({"CLB_1", transform}); }
  Script aim(float depth_mm, float aside_mm = 0.0F) {
    Transform target;
    target.columns[9] = aside_mm;
    target.columns[11] = depth_mm;
    return send({"TGT_1", target});
  }
  Script wait_ms(std::int64_t ms) {
    Script all;
    for (std::int64_t i = 0; i < ms; ++i) {
      now_us += 1'000;
      for (std::string& one : answers(protocol.tick(robot, now_us))) all.push_back(std::move(one));
    }
    return all;
  }
  // The text of the last status that came.
  std::string reason() const {
    for (auto message = last.rbegin(); message != last.rend(); ++message)
      if (const auto* status = std::get_if<Status>(&message->body)) return status->message;
    return {};
  }

  // The person at the console and the supervisor, as far as a navigation program sees them.
  void console_plans(std::uint32_t steps = 1) {
    robot.answered = protocol.wish().proposal;
    robot.planned = true;
    robot.confirmed = false;
    robot.steps = steps;
  }
  void person_confirms_and_arms() {
    robot.confirmed = true;
    robot.mode = Mode::Ready;
    wait_ms(1);
    robot.mode = Mode::Armed;
    wait_ms(1);
  }
  // Up to an accepted target at 3.5 mm.
  void targeted() {
    command("START_UP");
    command("PLANNING");
    command("CALIBRATION");
    calibrate();
    command("TARGETING");
    aim(3.5F);
    console_plans();
    wait_ms(1);
    ASSERT_EQ(robot.answered, 1U);
  }
  void moving() {
    targeted();
    person_confirms_and_arms();
    command("MOVE_TO_TARGET");
    robot.mode = Mode::Active;
    robot.depth = Millimetres(1.0);
    ASSERT_TRUE(protocol.wish().motion);
  }
};

}  // namespace biopsy::igtl
