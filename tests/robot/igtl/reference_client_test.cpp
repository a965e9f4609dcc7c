// A navigation program that is written with Debian's libopenigtlink, over TCP, through every phase of both
// dialects in the strict order of the table: each message that is read must be the next one.
#include <gtest/gtest.h>
#include <igtlClientSocket.h>
#include <igtlMessageHeader.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>

#include <atomic>
#include <thread>

#include "robot/igtl/navigation_server.hpp"

namespace library = igtl;  // before ours of the same name

namespace biopsy::igtl {
namespace {

// Confirms, arms and moves as soon as it is asked, as a person who is always there would.
struct WillingRobot : RobotLink {
  RobotView now;
  WillingRobot() {
    now.heard = now.console = now.measured = now.planned = now.confirmed = true;
    now.mode = Mode::Safe;
    now.steps = 1;
  }
  RobotView view(std::int64_t) override { return now; }
  void tell(const Wish& wish, std::int64_t) override {
    now.answered = wish.proposal;
    const bool stopped = wish.stop != StopCategory::None;
    now.mode = stopped ? Mode::Safe : wish.proposal != 0 ? Mode::Armed : Mode::Safe;
    if (!wish.motion || stopped) return;
    now.depth = Millimetres(now.depth.value + 0.05);
    now.step_done = now.depth.value >= 3.5;
    now.mode = now.step_done ? Mode::Hold : Mode::Active;
  }
};

class ReferenceClient {
 public:
  explicit ReferenceClient(int port) {
    connected_ = socket_->ConnectToServer("127.0.0.1", port) == 0;
    socket_->SetTimeout(10'000);
  }
  bool connected() const { return connected_; }
  void command(const char* device, const char* text) {
    auto message = library::StringMessage::New();
    message->SetDeviceName(device);
    message->SetString(text);
    send(*message);
  }
  void pose(const char* device, float z) {
    library::Matrix4x4 matrix;
    library::IdentityMatrix(matrix);
    matrix[2][3] = z;
    auto message = library::TransformMessage::New();
    message->SetDeviceName(device);
    message->SetMatrix(matrix);
    send(*message);
  }
  // "STATUS START_UP 1" of the next message, its CRC checked.
  std::string next() {
    auto header = library::MessageHeader::New();
    header->InitPack();
    if (socket_->Receive(header->GetPackPointer(), header->GetPackSize()) != header->GetPackSize())
      return "nothing";
    header->Unpack();
    const std::string type = header->GetDeviceType(), device = header->GetDeviceName();
    std::string text = type + " " + device;
    if (type == "STRING") text += " " + std::string(body<library::StringMessage>(*header)->GetString());
    if (type == "STATUS") {
      const auto status = body<library::StatusMessage>(*header);
      text += " " + std::to_string(status->GetCode());
      if (device == "CURRENT_STATUS") text += " " + std::string(status->GetErrorName());
    }
    if (type == "TRANSFORM") {
      library::Matrix4x4 matrix;
      body<library::TransformMessage>(*header)->GetMatrix(matrix);
      z_ = matrix[2][3];
    }
    return text;
  }
  float z() const { return z_; }

 private:
  template <class Kind>
  typename Kind::Pointer body(library::MessageHeader& header) {
    auto message = Kind::New();
    message->SetMessageHeader(&header);
    message->AllocatePack();
    EXPECT_EQ(socket_->Receive(message->GetPackBodyPointer(), message->GetPackBodySize()),
              message->GetPackBodySize());
    EXPECT_TRUE(message->Unpack(1) & library::MessageHeader::UNPACK_BODY) << "CRC";
    return message;
  }
  void send(library::MessageBase& message) {
    message.Pack();
    EXPECT_TRUE(socket_->Send(message.GetPackPointer(), message.GetPackSize()));
  }

  library::ClientSocket::Pointer socket_ = library::ClientSocket::New();
  bool connected_ = false;
  float z_ = 0.0F;
};

class IgtlReferenceClient : public testing::TestWithParam<Dialect> {};
INSTANTIATE_TEST_SUITE_P(Dialects, IgtlReferenceClient, testing::Values(Dialect::Of2013, Dialect::Of2021),
                         [](const auto& dialect) {
                           return dialect.param == Dialect::Of2013 ? "Of2013" : "Of2021";
                         });

TEST_P(IgtlReferenceClient, GoesThroughEveryPhaseInTheStrictOrder) {
  const bool of_2021 = GetParam() == Dialect::Of2021;
  WillingRobot robot;
  ServerSettings settings;
  settings.port = 0;
  NavigationServer server(settings, GetParam(), {}, robot);
  const std::jthread turning([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) server.turn(std::chrono::milliseconds(1));
  });
  ReferenceClient client(server.port());
  ASSERT_TRUE(client.connected());
  const auto phase = [&](const std::string& name) {
    client.command("CMD_0001", name.c_str());
    EXPECT_EQ(client.next(), "STRING ACK_0001 " + name);
    EXPECT_EQ(client.next(), "STATUS CURRENT_STATUS 1 " + name);
  };
  phase("START_UP");
  EXPECT_EQ(client.next(), "STATUS START_UP 1");
  phase("PLANNING");
  if (of_2021) {
    EXPECT_EQ(client.next(), "STATUS PLANNING 1");
  }
  phase("CALIBRATION");
  if (of_2021) {
    EXPECT_EQ(client.next(), "STATUS CALIBRATION 1");
  }
  client.pose("CLB_0004", 0.0F);
  EXPECT_EQ(client.next(), "TRANSFORM ACK_0004");
  EXPECT_EQ(client.next(), "STATUS CALIBRATION 1");
  phase("TARGETING");
  EXPECT_EQ(client.next(), "STATUS TARGETING 1");
  client.pose("TGT_0005", 5'000.0F);
  EXPECT_EQ(client.next(), "TRANSFORM ACK_0005");
  EXPECT_EQ(client.next(), "STATUS TARGET 10");
  client.pose("TGT_0006", 3.5F);
  EXPECT_EQ(client.next(), "TRANSFORM ACK_0006");
  EXPECT_EQ(client.z(), 3.5F);
  EXPECT_EQ(client.next(), "STATUS TARGET 1");
  EXPECT_EQ(client.next(), of_2021 ? "TRANSFORM REACHABLE_TARGET" : "TRANSFORM TARGET");
  phase("MOVE_TO_TARGET");
  if (of_2021) {
    EXPECT_EQ(client.next(), "STATUS MOVE_TO_TARGET 1");
  }
  std::string next = client.next();
  for (int n = 0; n < 1'000 && next == "TRANSFORM CURRENT_POSITION" && client.z() < 3.5F; ++n)
    next = client.next();
  if (!of_2021) {
    EXPECT_EQ(next, "STATUS MOVE_TO_TARGET 1");
    EXPECT_EQ(client.next(), "TRANSFORM CURRENT_POSITION");
  }
  EXPECT_NEAR(client.z(), 3.5, 0.1);
  for (const std::string name : {"MANUAL", "STOP", "EMERGENCY"}) {
    phase(name);
    EXPECT_EQ(client.next(), "STATUS " + name + " 1");
  }
  phase("MOVE_TO_TARGET");
  EXPECT_EQ(client.next(), "STATUS MOVE_TO_TARGET 13");
}

}  // namespace
}  // namespace biopsy::igtl
