#include "robot/transport/codec.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

namespace biopsy::transport {
namespace {

// Any bytes, as a broken or hostile writer may send them; the booleans are what the library's reader lets
// through.
template <class Wire>
Wire any_wire(std::mt19937& random) {
  Wire wire{};
  auto* bytes = reinterpret_cast<unsigned char*>(&wire);
  for (std::size_t n = 0; n < sizeof(Wire); ++n) bytes[n] = static_cast<unsigned char>(random());
  return wire;
}

template <class Message, class Wire>
Message there_and_back(const Message& message) {
  Wire wire{};
  encode(message, wire);
  Message back;
  decode(wire, back);
  return back;
}

TEST(Codec, CarriesEveryFieldOfAMeasurement) {
  Measurement m{.seq = 7, .time_us = -5, .depth_um = -123, .laser_code = 99, .laser_valid = true};
  m.monitor_mV = -8'000'000;
  m.current_nA = 1234;
  m.command_mV = 7'000'000;
  m.hv_enabled = true;
  m.answer = 0xdeadbeef;
  m.answered_seq = 6;
  m.verdict = GateVerdict::Limited;
  const Measurement back = there_and_back<Measurement, biopsy_wire_Measurement>(m);
  EXPECT_EQ(back.seq, m.seq);
  EXPECT_EQ(back.time_us, m.time_us);
  EXPECT_EQ(back.depth_um, m.depth_um);
  EXPECT_EQ(back.laser_code, m.laser_code);
  EXPECT_EQ(back.laser_valid, m.laser_valid);
  EXPECT_EQ(back.monitor_mV, m.monitor_mV);
  EXPECT_EQ(back.current_nA, m.current_nA);
  EXPECT_EQ(back.command_mV, m.command_mV);
  EXPECT_EQ(back.hv_enabled, m.hv_enabled);
  EXPECT_EQ(back.answer, m.answer);
  EXPECT_EQ(back.answered_seq, m.answered_seq);
  EXPECT_EQ(back.verdict, m.verdict);
}

TEST(Codec, CarriesEveryFieldOfAPermit) {
  Permit p;
  p.session = 1;
  p.epoch = 2;
  p.seq = 3;
  p.issued_us = 4;
  p.ttl_us = 5;
  p.mode = Mode::Active;
  p.stop = StopCategory::None;
  p.hv_enable = true;
  p.v_max_mV = 6;
  p.slew_up_mV_per_tick = 7;
  p.slew_down_mV_per_tick = 8;
  p.depth_max_um = 9;
  p.plan_tag = 0x8000'0000'0000'0001;
  p.config_tag = 11;
  p.challenge = 12;
  const Permit back = there_and_back<Permit, biopsy_wire_Permit>(p);
  EXPECT_EQ(std::memcmp(&back.session, &p.session, 3 * sizeof(std::uint32_t)), 0);
  EXPECT_EQ(back.issued_us, p.issued_us);
  EXPECT_EQ(back.ttl_us, p.ttl_us);
  EXPECT_EQ(back.mode, p.mode);
  EXPECT_EQ(back.stop, p.stop);
  EXPECT_EQ(back.hv_enable, p.hv_enable);
  EXPECT_EQ(back.v_max_mV, p.v_max_mV);
  EXPECT_EQ(back.slew_up_mV_per_tick, p.slew_up_mV_per_tick);
  EXPECT_EQ(back.slew_down_mV_per_tick, p.slew_down_mV_per_tick);
  EXPECT_EQ(back.depth_max_um, p.depth_max_um);
  EXPECT_EQ(back.plan_tag, p.plan_tag);
  EXPECT_EQ(back.config_tag, p.config_tag);
  EXPECT_EQ(back.challenge, p.challenge);
}

TEST(Codec, CarriesARequestAndAnAct) {
  DriveRequest r{
      .seq = 1, .wanted_mV = -2, .stage = 3, .stage_reached = true, .finished = true, .overruns = 4};
  r.measured_seq = 5;
  r.setpoint_um = 6;
  const DriveRequest back = there_and_back<DriveRequest, biopsy_wire_DriveRequest>(r);
  EXPECT_EQ(back.wanted_mV, -2);
  EXPECT_EQ(back.stage, 3U);
  EXPECT_TRUE(back.stage_reached && back.finished);
  EXPECT_EQ(back.overruns, 4U);
  EXPECT_EQ(back.measured_seq, 5U);
  EXPECT_EQ(back.setpoint_um, 6);
  OperatorAct a{.seq = 1, .token = 9, .held = true, .stop = StopCategory::C1Ramp, .finish = true};
  a.patient_motion_um = 77;
  const OperatorAct act = there_and_back<OperatorAct, biopsy_wire_OperatorAct>(a);
  EXPECT_EQ(act.token, 9U);
  EXPECT_TRUE(act.held && act.finish && act.acquiring);
  EXPECT_EQ(act.stop, StopCategory::C1Ramp);
  EXPECT_EQ(act.patient_motion_um, 77);
}

TEST(Codec, TurnsUnknownCodesIntoWhatAllowsLeast) {
  std::mt19937 random(1);
  for (int round = 0; round < 2'000; ++round) {
    auto wire = any_wire<biopsy_wire_Permit>(random);
    wire.hv_enable = true;
    Permit permit;
    decode(wire, permit);
    EXPECT_LE(permit.mode, Mode::Lock);
    EXPECT_LE(permit.stop, StopCategory::C0Off);
    if (wire.mode > static_cast<int>(Mode::Lock)) {
      EXPECT_EQ(permit.mode, Mode::Lock);
    }
    if (wire.stop > static_cast<int>(StopCategory::C0Off)) {
      EXPECT_EQ(permit.stop, StopCategory::C0Off);
    }
    auto measured = any_wire<biopsy_wire_Measurement>(random);
    measured.laser_valid = measured.hv_enabled = true;
    Measurement measurement;
    decode(measured, measurement);
    if (measured.verdict > static_cast<int>(GateVerdict::Limited)) {
      EXPECT_EQ(measurement.verdict, GateVerdict::Refused);
    }
  }
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

}  // namespace
}  // namespace biopsy::transport
