// The port against hostile clients, and what it holds open for how long. Loopback.
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <random>

#include "tests/robot/igtl/server_bench.hpp"

namespace biopsy::igtl {
namespace {

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
    ASSERT_GE(end.size(), 2U) << "closed without a reason";
    EXPECT_EQ(end.back(), "closed");
    EXPECT_EQ(end[end.size() - 2], "STATUS CURRENT_STATUS 12 CLOSED");
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

// Two that hold nearly all that may wait: not the one that says a word more is closed, but the longest.
TEST(IgtlServer, WhoHoldsTheMostOfWhatWaitsIsClosedAndNobodyElse) {
  ServerSettings settings;
  settings.received_bytes = 400'000;
  Bench bench(settings);
  TestClient good(bench.port()), greedy(bench.port()), longest(bench.port());
  bench.command(good, "START_UP", 3);
  Image image;
  image.scalar = Image::Scalar::UInt8;
  image.size = {500, 500, 1};
  image.axes = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  image.voxels.assign(250'000, 7);
  std::vector<std::uint8_t> bytes = encode({"scan", image}, {});
  bytes.resize(199'000);
  greedy.send_bytes(bytes);
  bench.command(good, "PLANNING", 2);
  longest.send_bytes(bytes);
  longest.send_bytes(std::vector<std::uint8_t>(1'900, 7));
  for (int i = 0; i < 100; ++i) bench.server->turn(1ms);
  std::vector<std::uint8_t> part = encode({"CMD_1", Text{"TARGETING" + std::string(100, ' ')}}, {});
  const std::vector<std::uint8_t> rest(part.end() - 10, part.end());
  part.resize(part.size() - 10);
  good.send_bytes(part);
  EXPECT_EQ(bench.answers(longest, 2), (Script{"STATUS CURRENT_STATUS 12 CLOSED", "closed"}));
  EXPECT_EQ(greedy.came(), Script{});
  good.send_bytes(rest);
  EXPECT_EQ(bench.answers(good, 3).back(), "STATUS TARGETING 13");
}

TEST(IgtlServer, WhoFindsNoRoomLearnsWhy) {
  ServerSettings settings;
  settings.connections = 2;
  Bench bench(settings);
  TestClient first(bench.port()), second(bench.port());
  for (TestClient* client : {&first, &second}) {
    client->send({"x", Query::Status});
    bench.answers(*client, 1);
  }
  TestClient third(bench.port());
  EXPECT_EQ(bench.answers(third, 2), (Script{"STATUS CURRENT_STATUS 12 CLOSED", "closed"}));
  EXPECT_EQ(bench.server->connections(), 2U);
}

// Connections that spoke once and then keep their place: the longest silent one learns why it ends, and the
// program that controls is never the one.
TEST(IgtlServer, WhoIsSilentGivesWayButNotWhoControls) {
  ServerSettings settings;
  settings.connections = 3;
  settings.idle_gives_way = 0ms;  // whoever says nothing from now on
  Bench bench(settings);
  TestClient navigation(bench.port());
  bench.command(navigation, "START_UP", 3);
  TestClient second(bench.port()), third(bench.port());
  for (TestClient* client : {&third, &second}) {
    client->send({"x", Query::Status});
    bench.answers(*client, 1);
  }
  TestClient fourth(bench.port());
  EXPECT_EQ(bench.answers(third, 2), (Script{"STATUS CURRENT_STATUS 12 CLOSED", "closed"}));
  EXPECT_EQ(bench.command(fourth, "STOP", 3).back(), "STATUS STOP 1");
  EXPECT_EQ(bench.command(navigation, "PLANNING", 2)[0], "STRING ACK_1 PLANNING");
  EXPECT_EQ(bench.server->connections(), 3U);
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
