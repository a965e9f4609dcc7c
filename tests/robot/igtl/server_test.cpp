// The port against clients that keep to the protocol. Loopback.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "robot/common/config_error.hpp"
#include "tests/robot/igtl/server_bench.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::igtl {
namespace {

TEST(IgtlServer, ServesAWholeProcedureOverTcp) {
  Bench bench;
  TestClient client(bench.port());
  bench.move(client);
  bench.robot.now.mode = Mode::Hold;
  bench.robot.now.step_done = true;
  Script end;
  ASSERT_TRUE(bench.turn_until([&] {
    for (std::string& one : client.came()) end.push_back(std::move(one));
    return !end.empty() && std::ranges::find(end, "STATUS MOVE_TO_TARGET 1") != end.end() &&
           end.back() == "TRANSFORM CURRENT_POSITION";
  }));
  EXPECT_EQ(bench.command(client, "STOP", 2), (Script{"STRING ACK_1 STOP", "STATUS CURRENT_STATUS 1 STOP"}));
  EXPECT_EQ(bench.robot.told.back().stop, StopCategory::C1Ramp);
}

TEST(IgtlServer, TellsTheRobotToStopBeforeItAcknowledges) {
  struct Witness : TableRobot {
    TestClient* client = nullptr;
    Script seen_before_stop;
    void tell(const Wish& wish, std::int64_t now_us) override {
      if (wish.stop == StopCategory::C0Off && told.back().stop != StopCategory::C0Off)
        seen_before_stop = client->came();
      TableRobot::tell(wish, now_us);
    }
  } robot;
  ServerSettings settings;
  settings.port = 0;
  NavigationServer server(settings, Dialect::Of2013, {}, robot);
  TestClient client(server.port());
  robot.client = &client;
  client.send({"CMD_1", Text{"EMERGENCY"}});
  Script came;
  for (const auto until = Clock::now() + kPatience; came.size() < 3 && Clock::now() < until;) {
    server.turn(1ms);
    for (std::string& one : client.came()) came.push_back(std::move(one));
  }
  EXPECT_EQ(came[0], "STRING ACK_1 EMERGENCY");
  ASSERT_EQ(robot.told.back().stop, StopCategory::C0Off);
  EXPECT_EQ(robot.seen_before_stop, Script{});
}

TEST(IgtlServer, AConnectionThatIsClosedIsAStop) {
  Bench bench;
  {
    TestClient client(bench.port());
    bench.move(client);
  }
  EXPECT_TRUE(bench.turn_until([&] { return bench.robot.told.back().stop == StopCategory::C1Ramp; }));
  EXPECT_FALSE(bench.robot.told.back().motion);
}

// Positions that nobody acknowledges, and a link that is silent.
TEST(IgtlServer, AHalfOpenConnectionIsFoundAndIsAStop) {
  for (const bool while_moving : {true, false}) {
    Bench bench;
    TestClient client(bench.port());
    bench.move(client);
    if (!while_moving) {  // at its target: nothing is sent that could be missed
      bench.robot.now.mode = Mode::Hold;
      bench.robot.now.step_done = true;
      bench.answers(client, 2);
    }
    client.pull_the_cable();
    const auto pulled = Clock::now();
    EXPECT_TRUE(bench.turn_until([&] { return bench.robot.told.back().stop == StopCategory::C1Ramp; }));
    EXPECT_LT(Clock::now() - pulled, ServerSettings{}.half_open);
  }
}

TEST(IgtlServer, OnlyOneControlsAndAnyoneMayStop) {
  Bench bench;
  TestClient first(bench.port()), second(bench.port());
  bench.move(first);
  EXPECT_EQ(bench.command(second, "PLANNING", 1), (Script{"STATUS CURRENT_STATUS 5 CMD_1"}));
  second.send({"TGT_1", Transform{}});
  EXPECT_EQ(bench.answers(second, 1), (Script{"STATUS CURRENT_STATUS 5 TGT_1"}));
  EXPECT_TRUE(bench.robot.told.back().motion);
  second.send({"CURRENT_STATUS", Query::Status});
  EXPECT_EQ(bench.answers(second, 1), (Script{"STATUS CURRENT_STATUS 1 MOVE_TO_TARGET"}));
  EXPECT_EQ(bench.command(second, "STOP", 2), (Script{"STRING ACK_1 STOP", "STATUS CURRENT_STATUS 1 STOP"}));
  EXPECT_EQ(bench.robot.told.back().stop, StopCategory::C1Ramp);
  bench.robot.now.mode = Mode::Safe;
  EXPECT_EQ(bench.answers(second, 1), (Script{"STATUS STOP 1"}));
}

// What another client sends at the moment an answer is ready does not take it: a tracker sends fifty times a
// second.
TEST(IgtlServer, AnAnswerThatHadToWaitGoesToWhoAsked) {
  for (const std::string other : {"PATIENT_MOTION", "Probe", "a query"}) {
    Bench bench;
    bench.robot.now.mode = Mode::Boot;
    TestClient navigation(bench.port()), another(bench.port());
    bench.command(navigation, "START_UP", 2);
    if (other == "a query")
      another.send({"", Query::Status});
    else
      another.send({other, Transform{}});
    bench.robot.now.mode = Mode::Safe;
    EXPECT_EQ(bench.answers(navigation, 1), (Script{"STATUS START_UP 1"})) << other;
    Script to_another = another.came();
    std::erase_if(to_another,
                  [](const std::string& one) { return one.starts_with("STATUS CURRENT_STATUS"); });
    EXPECT_EQ(to_another, Script{}) << other;
  }
}

// The motion that another stopped ends for the one who asked for it, too.
TEST(IgtlServer, WhoWaitsForAnAnswerLearnsThatAnotherStopped) {
  for (const std::string stop : {"STOP", "EMERGENCY"}) {
    Bench bench;
    TestClient first(bench.port()), second(bench.port());
    bench.move(first);
    EXPECT_EQ(bench.command(second, stop, 2)[0], "STRING ACK_1 " + stop);
    Script told;
    ASSERT_TRUE(bench.turn_until([&] {
      for (std::string& one : first.came())
        if (one != "TRANSFORM CURRENT_POSITION") told.push_back(std::move(one));
      return !told.empty();
    }));
    EXPECT_EQ(told, (Script{"STATUS MOVE_TO_TARGET 13"}));
  }
}

// Every command and target has its answer where the same program is quicker than the robot, in the order in
// which they were sent. A stop's own answers end an insertion; a command that is repeated is answered once.
TEST(IgtlServer, WhatTheNextOvertakesIsAnsweredBeforeIt) {
  Bench bench;
  TestClient client(bench.port());
  bench.command(client, "START_UP", 3);
  bench.command(client, "CALIBRATION", 2);
  client.send({"CLB_1", Transform{}});
  bench.answers(client, 2);
  bench.command(client, "TARGETING", 3);
  Transform target;
  for (const float depth : {4.5F, 6.0F}) {
    target.columns[11] = depth;
    client.send({"TGT_2", target});
  }
  EXPECT_EQ(bench.answers(client, 3), (Script{"TRANSFORM ACK_2", "STATUS TARGET 13", "TRANSFORM ACK_2"}));
  EXPECT_EQ(bench.command(client, "PLANNING", 3),
            (Script{"STATUS TARGET 13", "STRING ACK_1 PLANNING", "STATUS CURRENT_STATUS 1 PLANNING"}));
  bench.robot.now.mode = Mode::Active;  // does not follow a stop
  bench.command(client, "STOP", 2);
  EXPECT_EQ(bench.command(client, "EMERGENCY", 3),
            (Script{"STATUS STOP 13", "STRING ACK_1 EMERGENCY", "STATUS CURRENT_STATUS 1 EMERGENCY"}));
  EXPECT_EQ(bench.command(client, "EMERGENCY", 2),
            (Script{"STRING ACK_1 EMERGENCY", "STATUS CURRENT_STATUS 1 EMERGENCY"}));
}

// A tracker, a program that watches and one that only stops do not keep the navigation program out.
TEST(IgtlServer, OnlyWhoCommandsControls) {
  Bench bench({}, {}, Dialect::Of2021);
  TestClient watcher(bench.port()), navigation(bench.port());
  watcher.send({"Probe", Transform{}});
  EXPECT_EQ(bench.answers(watcher, 1), (Script{"STATUS CURRENT_STATUS 12 Probe"}));
  bench.command(watcher, "HELLO", 2);
  EXPECT_EQ(bench.command(watcher, "EMERGENCY", 3).back(), "STATUS EMERGENCY 1");
  EXPECT_EQ(bench.command(navigation, "START_UP", 3).back(), "STATUS START_UP 1");
  EXPECT_EQ(bench.command(watcher, "CURRENT_POSITION", 1), (Script{"STATUS CURRENT_POSITION 13"}));
  EXPECT_EQ(bench.command(watcher, "PLANNING", 1), (Script{"STATUS CURRENT_STATUS 5 CMD_1"}));
}

TEST(IgtlServer, AnotherMayControlOnceTheFirstHasGone) {
  Bench bench;
  TestClient second(bench.port());
  {
    TestClient first(bench.port());
    bench.command(first, "START_UP", 3);
    EXPECT_EQ(bench.command(second, "START_UP", 1)[0], "STATUS CURRENT_STATUS 5 CMD_1");
  }
  ASSERT_TRUE(bench.turn_until([&] { return bench.server->connections() == 1; }));
  EXPECT_EQ(bench.command(second, "START_UP", 3).back(), "STATUS START_UP 1");
}

TEST(IgtlServer, AProgramThatComesBackAtOnceControls) {
  Bench bench;
  auto first = std::make_unique<TestClient>(bench.port());
  bench.command(*first, "START_UP", 3);
  TestClient second(bench.port());
  bench.server->turn(1ms);
  first.reset();  // both are there when the server looks next
  EXPECT_EQ(bench.command(second, "START_UP", 3).back(), "STATUS START_UP 1");
}

TEST(IgtlServer, WritesImagesIntoItsFolderOrRefusesThem) {
  ScratchFolder folder;
  Image image;
  image.scalar = Image::Scalar::UInt8;
  image.size = {3, 3, 3};
  image.axes = {0.5F, 0, 0, 0, 0.5F, 0, 0, 0, 2};
  image.centre = {10, 20, 30};
  image.voxels.resize(27);
  image.voxels[0] = 7, image.voxels[26] = 9;
  Bench bench({}, folder.path());
  TestClient client(bench.port());
  client.send({"../scan 1", image});
  EXPECT_EQ(bench.answers(client, 1), (Script{"STATUS ../scan 1 1"}));
  const std::string nrrd = file_content(folder / "igtl-001-scan1.nrrd");
  EXPECT_NE(nrrd.find("space: left-posterior-superior\n"), std::string::npos);
  EXPECT_NE(nrrd.find("space directions: (-0.5,-0,0) (-0,-0.5,0) (-0,-0,2)\n"), std::string::npos) << nrrd;
  EXPECT_NE(nrrd.find("space origin: (-9.5,-19.5,28)\n"), std::string::npos) << nrrd;
  EXPECT_TRUE(nrrd.ends_with("\n\n\7" + std::string(25, '\0') + "\11"));
  Bench again({}, folder.path());  // started again: what came before stays
  TestClient later(again.port());
  later.send({"scan", image});
  EXPECT_EQ(again.answers(later, 1), (Script{"STATUS scan 1"}));
  EXPECT_TRUE(std::filesystem::exists(folder / "igtl-002-scan.nrrd"));
  EXPECT_EQ(file_content(folder / "igtl-001-scan1.nrrd"), nrrd);
  Bench without;
  TestClient other(without.port());
  other.send({"scan", image});
  EXPECT_EQ(without.answers(other, 1), (Script{"STATUS scan 10"}));
  EXPECT_THROW(Bench({}, folder / "nowhere"), ConfigError);
}

// A disk that does not take the image: a pipe that nobody reads lies where it would be written.
// What could not be read again as a file of the watched folder is refused to its sender, and leaves no file.
TEST(IgtlServer, RefusesImagesThatNobodyCouldPlanOn) {
  ScratchFolder folder;
  Bench bench({}, folder.path());
  TestClient client(bench.port());
  Image good;
  good.scalar = Image::Scalar::Float32;
  good.size = {4, 3, 5};
  good.axes = {0, 0.8F, 0, 0, 0, 1.2F, 2.5F, 0, 0};
  good.voxels.resize(4 * 60);
  Image sheared = good, flat = good, far = good, gap = good, infinite = good;
  sheared.axes[4] = 0.1F;
  flat.axes[6] = 0.0F;
  far.centre[1] = 2e4F;
  gap.voxels[4 * 17 + 2] = 0xC0, gap.voxels[4 * 17 + 3] = 0x7F;  // NaN
  infinite.scalar = Image::Scalar::Float64;
  infinite.voxels.resize(8 * 60);
  infinite.voxels[8 * 59 + 6] = 0xF0, infinite.voxels[8 * 59 + 7] = 0xFF;  // minus infinity
  for (const Image& image : {sheared, flat, far, gap, infinite}) {
    client.send({"scan", image});
    EXPECT_EQ(bench.answers(client, 1), (Script{"STATUS scan 10"}));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  client.send({"scan", good});
  EXPECT_EQ(bench.answers(client, 1), (Script{"STATUS scan 1"}));
}

TEST(IgtlServer, NoStopWaitsForAnImageThatIsBeingWritten) {
  ScratchFolder folder;
  Bench bench({}, folder.path());
  const std::filesystem::path pipe = folder / fmt::format("igtl-001-scan.nrrd.part{}", getpid());
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  Image image;
  image.scalar = Image::Scalar::UInt8;
  image.size = {3, 3, 3};
  image.axes = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  image.voxels.resize(27);
  TestClient client(bench.port());
  client.send({"scan", image});
  EXPECT_EQ(bench.command(client, "STOP", 3),
            (Script{"STRING ACK_1 STOP", "STATUS CURRENT_STATUS 1 STOP", "STATUS STOP 1"}));
  EXPECT_EQ(bench.robot.told.back().stop, StopCategory::C1Ramp);
  EXPECT_EQ(client.came(), Script{});
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  Script later;
  bench.turn_until([&] {
    for (std::string& one : client.came()) later.push_back(std::move(one));
    return std::ranges::find(later, "STATUS scan 1") != later.end();
  });
  EXPECT_NE(std::ranges::find(later, "STATUS scan 1"), later.end());
  close(reader);
}

TEST(IgtlServer, SaysWhyItCannotListen) {
  Bench bench;
  TableRobot robot;
  ServerSettings settings;
  settings.port = bench.port();
  EXPECT_THROW(NavigationServer(settings, Dialect::Of2013, {}, robot), ConfigError);
  settings.address = "here";
  EXPECT_THROW(NavigationServer(settings, Dialect::Of2013, {}, robot), ConfigError);
}

// Who measures the patient need not be who controls; a second one would contradict it.
TEST(IgtlServer, TakesThePatientsMotionFromOneClientUntilItGoes) {
  Bench bench;
  auto first = std::make_unique<TestClient>(bench.port());
  TestClient second(bench.port());
  const auto moved = [](float mm) {
    Transform transform;
    transform.columns[11] = mm;
    return Message{"PATIENT_MOTION", transform};
  };
  const auto is_told = [&](double mm) {
    return bench.turn_until([&] {
      return !bench.robot.told.empty() && bench.robot.told.back().patient_motion &&
             bench.robot.told.back().patient_motion->value == mm;
    });
  };
  first->send(moved(3.0F));
  EXPECT_TRUE(is_told(3.0));
  second.send(moved(0.0F));
  EXPECT_EQ(bench.answers(second, 1), (Script{"STATUS CURRENT_STATUS 5 PATIENT_MOTION"}));
  EXPECT_TRUE(is_told(3.0) || is_told(std::numeric_limits<double>::infinity()));
  first.reset();
  EXPECT_TRUE(bench.turn_until([&] { return bench.server->connections() == 1; }));
  second.send(moved(1.0F));
  EXPECT_TRUE(is_told(1.0));
}

}  // namespace
}  // namespace biopsy::igtl
