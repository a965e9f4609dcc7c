// The port against clients of all kinds: ours by the codec, and hostile ones. Loopback; the robot is a table.
// No test waits for a time that it could compute: it turns the server until what it expects is there.
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <random>

#include "robot/common/config_error.hpp"
#include "robot/igtl/navigation_server.hpp"
#include "tests/robot/igtl/scripted_robot.hpp"
#include "tests/robot/igtl/test_client.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::igtl {
namespace {

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
        told.back().proposal != wish.proposal)
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
    ServerSettings settings;
    settings.half_open = 1s;
    Bench bench(settings);
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
    EXPECT_LT(Clock::now() - pulled, 6s);
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

TEST(IgtlServer, WritesImagesIntoItsFolderOrRefusesThem) {
  ScratchFolder folder;
  Image image;
  image.scalar = Image::Scalar::UInt8;
  image.size = {2, 1, 1};
  image.axes = {0.5F, 0, 0, 0, 0.5F, 0, 0, 0, 2};
  image.centre = {10, 20, 30};
  image.voxels = {7, 9};
  Bench bench({}, folder.path());
  TestClient client(bench.port());
  client.send({"../scan 1", image});
  EXPECT_EQ(bench.answers(client, 1), (Script{"STATUS ../scan 1 1"}));
  const std::string nrrd = file_content(folder / "igtl-001-scan1.nrrd");
  EXPECT_NE(nrrd.find("space: left-posterior-superior\n"), std::string::npos);
  EXPECT_NE(nrrd.find("space directions: (-0.5,-0,0) (-0,-0.5,0) (-0,-0,2)\n"), std::string::npos) << nrrd;
  EXPECT_NE(nrrd.find("space origin: (-9.75,-20,30)\n"), std::string::npos) << nrrd;
  EXPECT_TRUE(nrrd.ends_with(std::string("\n\n\7\11")));
  Bench without;
  TestClient other(without.port());
  other.send({"scan", image});
  EXPECT_EQ(without.answers(other, 1), (Script{"STATUS scan 10"}));
  EXPECT_THROW(Bench({}, folder / "nowhere"), ConfigError);
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

// Hostile clients. After each the navigation program that controls is served as before.
class IgtlHostile : public testing::Test {
 protected:
  Bench bench{[] {
    ServerSettings settings;
    settings.message_time = 100ms;
    settings.unsent_bytes = 65'536;
    return settings;
  }()};
  TestClient good{bench.port()};
  void SetUp() override { bench.command(good, "START_UP", 3); }
  void TearDown() override {
    const std::size_t told = bench.robot.told.size();
    EXPECT_EQ(bench.command(good, "TARGETING", 3).back(), "STATUS TARGETING 13");
    EXPECT_EQ(bench.robot.told.size(), told) << "a hostile client changed what is wished";
    EXPECT_EQ(bench.robot.told.back().stop, StopCategory::None);
  }
  void expect_closed(TestClient& client) {
    const Script end = bench.answers(client, 100'000);
    ASSERT_FALSE(end.empty());
    EXPECT_EQ(end.back(), "closed");
  }
};

TEST_F(IgtlHostile, OtherProtocolsAreClosed) {
  TestClient browser(bench.port());
  const std::string request =
      "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nUser-Agent: a browser of the present day\r\n\r\n";
  browser.send_bytes({request.begin(), request.end()});
  expect_closed(browser);
}

TEST_F(IgtlHostile, AHugeBodyIsClosedByItsHeader) {
  for (const std::size_t place : {42U, 43U, 44U, 45U}) {
    TestClient client(bench.port());
    std::vector<std::uint8_t> bytes = encode({"CMD_1", Text{"STOP"}}, {});
    bytes[place] = 0x7F;
    client.send_bytes(bytes);
    expect_closed(client);
  }
}

TEST_F(IgtlHostile, AMessageThatDoesNotEndIsClosedInTime) {
  TestClient client(bench.port());
  std::vector<std::uint8_t> bytes = encode({"CMD_1", Text{"EMERGENCY"}}, {});
  bytes.pop_back();
  client.send_bytes(bytes);
  expect_closed(client);
}

TEST_F(IgtlHostile, AFloodOfMessagesIsClosed) {
  TestClient client(bench.port());
  const std::vector<std::uint8_t> one = encode({"x", Query::Status}, {});
  std::vector<std::uint8_t> flood;
  for (int i = 0; i < 600; ++i) flood.insert(flood.end(), one.begin(), one.end());
  client.send_bytes(flood);
  expect_closed(client);
}

// It asks, and never reads: what it would be told piles up, and ends it.
TEST_F(IgtlHostile, AClientThatDoesNotReadIsClosed) {
  TestClient client(bench.port());
  const int small = 4'096;
  setsockopt(client.socket_number(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
  const std::vector<std::uint8_t> question = encode({"x", Unusable{std::string(12, 'Z'), ""}}, {});
  std::vector<std::uint8_t> questions;
  for (int i = 0; i < 100; ++i) questions.insert(questions.end(), question.begin(), question.end());
  const auto until = Clock::now() + kPatience;
  ssize_t sent = 0;
  while (sent >= 0 && Clock::now() < until) {
    sent = ::send(client.socket_number(), questions.data(), questions.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) sent = 0;
    bench.server->turn(1ms);
  }
  EXPECT_LT(sent, 0) << "still connected";
}

TEST_F(IgtlHostile, AThousandSilentConnectionsLeaveRoomForOneThatSpeaks) {
  std::vector<std::unique_ptr<TestClient>> silent;
  for (int i = 0; i < 1'000; ++i) {
    silent.push_back(std::make_unique<TestClient>(bench.port()));
    bench.server->turn(0ms);
    if (i % 100 == 99) {
      TestClient client(bench.port());
      EXPECT_EQ(bench.command(client, "STOP", 1)[0], "STRING ACK_1 STOP") << i;
      bench.robot.told.clear();
      ASSERT_TRUE(bench.turn_until(
          [&] { return !bench.robot.told.empty() && bench.robot.told.back().stop == StopCategory::None; }));
    }
  }
  EXPECT_LE(bench.server->connections(), 16U);
  ASSERT_EQ(bench.command(good, "START_UP", 3).back(), "STATUS START_UP 1");
}

TEST_F(IgtlHostile, RandomBytesInManyConnectionsDoNothing) {
  std::mt19937 random(11);
  for (int round = 0; round < 300; ++round) {
    TestClient client(bench.port());
    std::vector<std::uint8_t> bytes(1 + random() % 3'000);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    if (round % 2 == 0)
      bytes[0] = 0, bytes[std::min<std::size_t>(1, bytes.size() - 1)] = 1;  // the right version
    client.send_bytes(bytes);
    bench.server->turn(0ms);
  }
  ASSERT_TRUE(bench.turn_until([&] { return bench.server->connections() == 1; }));
}

}  // namespace
}  // namespace biopsy::igtl
