// An attacker without keys on the same network forges the next sample of the controller.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "tests/robot/security/bus_probe.hpp"
#include "tests/robot/security/test_key_set.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::security {
namespace {

// One RTPS message with one sample in it (OMG DDSI-RTPS 2.2, 9.4.5.3), little endian.
using Message = std::array<std::uint8_t, 52>;

Message sample_of(const dds_guid_t& writer, std::uint8_t number, std::uint8_t value) {
  Message message{'R', 'T', 'P', 'S', 2, 1, 1, 16};
  std::copy_n(writer.v, 12, &message[8]);  // as if it came from the writer's participant
  const std::array<std::uint8_t, 8> data{0x15, 0x05, 28, 0, 0, 0, 16, 0};
  std::ranges::copy(data, &message[20]);
  std::copy_n(&writer.v[12], 4, &message[32]);  // to every reader, as if from this writer
  message[40] = number;                         // of 8 bytes, the upper half first
  message[45] = 1;                              // CDR, little endian
  message[48] = value;
  return message;
}

// To every participant of the domain on this machine (DDSI-RTPS 9.6.1: the ports of a participant).
void send_to_all(const Message& message, int domain) {
  const int wire = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  for (int participant = 0; participant < 33; ++participant) {
    to.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * domain + 11 + 2 * participant));
    sendto(wire, message.data(), message.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
  close(wire);
}

// What the stage receives after 1 from the controller, when 66 is forged and 2 follows from the controller.
std::optional<std::int32_t> received_after_forging(int domain,
                                                   const std::optional<std::filesystem::path>& keys) {
  const auto of = [&keys](Role role) { return keys ? std::optional(Security{*keys, role}) : std::nullopt; };
  BusProbe stage(domain, of(Role::Stage)), controller(domain, of(Role::Controller));
  stage.open_reader(kTopic<DriveRequest>.name);
  controller.open_writer(kTopic<DriveRequest>.name);
  if (!controller.matches_a_reader() || !controller.write(1) || stage.next() != 1) return std::nullopt;
  send_to_all(sample_of(controller.writer_guid(), 2, 66), domain);
  controller.write(2);
  return stage.next();
}

// Shows that the forged message is well formed, so that the test below is about the signature.
TEST(ForgedSample, IsAcceptedOnABusWithoutSecurity) {
  EXPECT_EQ(received_after_forging(205, std::nullopt), 66);
}

TEST(ForgedSample, IsRejectedOnATopicThatIsSignedAndNotEncrypted) {
  verifies("R-46");
  const TestKeySet set;
  EXPECT_EQ(received_after_forging(206, set.folder()), 2);
}

}  // namespace
}  // namespace biopsy::security
