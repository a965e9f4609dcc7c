// What decoding makes of what no writer of ours sends. That every field comes back is a property:
// tests/verification/properties/codec_test.cpp.
#include "robot/transport/codec.hpp"

#include <gtest/gtest.h>

#include <cstring>

namespace biopsy::transport {
namespace {

TEST(Codec, TurnsUnknownCodesIntoWhatAllowsLeast) {
  for (int code = 0; code < 256; ++code) {
    biopsy_wire_Permit wire{};
    wire.mode = wire.stop = static_cast<std::uint8_t>(code);
    Permit permit;
    decode(wire, permit);
    EXPECT_EQ(permit.mode, code <= 8 ? static_cast<Mode>(code) : Mode::Lock);
    EXPECT_EQ(permit.stop, code <= 3 ? static_cast<StopCategory>(code) : StopCategory::C0Off);
    biopsy_wire_Measurement measured{};
    measured.verdict = static_cast<std::uint8_t>(code);
    Measurement measurement;
    decode(measured, measurement);
    EXPECT_EQ(measurement.verdict, code <= 10 ? static_cast<GateVerdict>(code) : GateVerdict::Refused);
  }
}

TEST(Codec, AMessageThatWasNotReceivedAllowsNothing) {
  EXPECT_EQ(Permit().mode, Mode::Boot);
  EXPECT_EQ(Permit().stop, StopCategory::C0Off);
  EXPECT_FALSE(Permit().hv_enable);
  EXPECT_EQ(Permit().v_max_mV, 0);
  EXPECT_EQ(Measurement().verdict, GateVerdict::Refused);
  EXPECT_FALSE(Measurement().laser_valid);
  EXPECT_TRUE(OperatorAct().acquiring);
  EXPECT_FALSE(OperatorAct().held);
  EXPECT_TRUE(Decision().image_disturbed);
  EXPECT_EQ(Decision().stop, StopCategory::C0Off);
}

TEST(Codec, ATextWithoutItsEndStaysInItsBounds) {
  biopsy_wire_Health wire{};
  std::memset(wire.note, 'x', sizeof(wire.note));
  Health health;
  decode(wire, health);
  EXPECT_EQ(health.note.size(), sizeof(wire.note));
  health.note.assign(1'000, 'y');
  encode(health, wire);
  EXPECT_EQ(std::strlen(wire.note), sizeof(wire.note) - 1);
}

TEST(Codec, ASequenceIsCutAtItsBound) {
  SealedPlan plan;
  plan.bytes.assign(70'000, 1);
  biopsy_wire_SealedPlan wire{};
  encode(plan, wire);
  EXPECT_EQ(wire.bytes._length, 60'000U);
}

}  // namespace
}  // namespace biopsy::transport
