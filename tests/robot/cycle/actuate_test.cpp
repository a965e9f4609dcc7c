// What a stage process can get wrong: which request, permit, clock and count reach the gate.
#include "robot/cycle/actuate.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "safety/challenge.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::robot {
namespace {

struct Recorded final : drivers::NeedleStage {
  std::int32_t mV = -1;
  std::int32_t most_mV = 8'000'000;  // of this driver's converter
  bool enabled = true;
  drivers::SensorReading read() override { return {.time_us = 6, .depth_um = 7, .laser_valid = true}; }
  std::int32_t write(const safety::GatedVoltage& voltage) override {
    mV = std::clamp(voltage.mV(), -most_mV, most_mV);
    enabled = voltage.hv_enabled();
    return mV;
  }
};

GateInputs raising(std::uint32_t seq) {
  GateInputs in;
  in.request = {.seq = seq, .wanted_mV = 50'000};
  in.permit = {.session = 1,
               .epoch = 1,
               .seq = seq,
               .ttl_us = 5'000,
               .mode = Mode::Active,
               .stop = StopCategory::None,
               .hv_enable = true,
               .v_max_mV = 8'000'000,
               .slew_up_mV_per_tick = 400'000};
  in.now_us = 1'000 * static_cast<std::int64_t>(seq);
  in.writers = 1;
  return in;
}

struct Stage : testing::Test {
  Stage() {
    GateInputs off = raising(1);
    off.permit.mode = Mode::Safe, off.permit.stop = StopCategory::C0Off, off.permit.hv_enable = false;
    actuate(off, gated);  // binds the session
  }
  Recorded stage;
  drivers::GatedStage gated{stage, 9};
};

using Actuate = Stage;

TEST_F(Actuate, PutsOutWhatIsRequestedAndPermitted) {
  actuate(raising(2), gated);
  EXPECT_EQ(stage.mV, 50'000);
  EXPECT_TRUE(stage.enabled);
  const Measurement measured = gated.measure();
  EXPECT_EQ(measured.command_mV, 50'000);
  EXPECT_EQ(measured.depth_um, 7);
  EXPECT_EQ(measured.config_tag, 9U);
  EXPECT_EQ(measured.answered_seq, 2U);
}

// Numbers all different, each flag alone: a field that is read from its neighbour shows.
TEST_F(Actuate, CarriesEachFieldOfAReadingIntoTheMeasurement) {
  struct Reads final : drivers::NeedleStage {
    drivers::SensorReading reading;
    drivers::SensorReading read() override { return reading; }
    std::int32_t write(const safety::GatedVoltage& voltage) override { return voltage.mV(); }
  } reads;
  drivers::GatedStage other(reads, 9);
  for (int flag = 0; flag < 3; ++flag) {
    reads.reading = {.time_us = 11,
                     .depth_um = 12,
                     .laser_code = 13,
                     .laser_valid = flag == 0,
                     .depth_b_um = 14,
                     .laser_b_valid = flag == 1,
                     .monitor_mV = 15,
                     .current_nA = 16,
                     .brake_fitted = flag == 2};
    Measurement expected;
    expected.seq = static_cast<std::uint32_t>(flag + 1);
    expected.time_us = 11, expected.depth_um = 12, expected.laser_code = 13;
    expected.depth_b_um = 14, expected.monitor_mV = 15, expected.current_nA = 16;
    expected.laser_valid = flag == 0, expected.laser_b_valid = flag == 1, expected.brake_fitted = flag == 2;
    expected.config_tag = 9;
    EXPECT_EQ(other.measure(), expected);
  }
}

TEST_F(Actuate, SaysWhatTheGateDidAndFeedsTheInterlockOnceItHasAPermit) {
  EXPECT_FALSE(drivers::GatedStage(stage, 9).feeds_interlock()) << "nothing was driven yet";
  actuate(raising(2), gated);
  EXPECT_EQ(gated.measure().verdict, GateVerdict::Granted);
  EXPECT_TRUE(gated.measure().hv_enabled);
  EXPECT_FALSE(gated.measure().brake_on);
  EXPECT_TRUE(gated.feeds_interlock());
  GateInputs replayed = raising(3);
  replayed.permit.session = 2;
  actuate(replayed, gated);
  EXPECT_EQ(gated.measure().verdict, GateVerdict::WrongSession);
  GateInputs late = raising(2);
  late.now_us = 2'000 + 5'000;
  actuate(late, gated);
  EXPECT_EQ(gated.measure().verdict, GateVerdict::Expired);
}

// A driver that limits by itself, or cannot write, or writes something else: the supervisor checks the answer
// over the voltage that the measurement states.
TEST_F(Actuate, AVoltageThatTheDriverDidNotWriteAsItWasAskedMakesTheAnswerWrong) {
  verifies("R-10");
  const auto is_right = [](const Measurement& measured, const Permit& permit) {
    return measured.answer ==
           safety::answer_to(permit.challenge, measured.command_mV, permit.mode, measured.answered_seq);
  };
  actuate(raising(2), gated);
  EXPECT_TRUE(is_right(gated.measure(), raising(2).permit));
  stage.most_mV = 30'000;
  actuate(raising(3), gated);
  const Measurement limited = gated.measure();
  EXPECT_EQ(limited.command_mV, 30'000);
  EXPECT_FALSE(is_right(limited, raising(3).permit));
}

TEST_F(Actuate, RaisesNothingWithoutAPermitARequestOrTheOneWriter) {
  verifies("R-11", "R-44");
  GateInputs no_permit = raising(2), no_request = raising(2), two_writers = raising(2);
  no_permit.permit.seq = 0;
  no_request.request.seq = 0;
  two_writers.writers = 2;
  for (const GateInputs& in : {no_permit, no_request, two_writers}) {
    Recorded other;
    drivers::GatedStage fresh(other, 9);
    actuate(in, fresh);
    EXPECT_EQ(other.mV, 0);
  }
}

TEST_F(Actuate, ARequestWithoutANumberIsNone) {
  drivers::GatedStage fresh(stage, 9);
  GateInputs off = raising(1), first = raising(2);
  off.permit.mode = Mode::Safe, off.permit.stop = StopCategory::C0Off, off.permit.hv_enable = false;
  off.request.seq = 0, first.request.seq = 1;
  actuate(off, fresh);
  actuate(first, fresh);
  EXPECT_EQ(stage.mV, 50'000) << "the first has number 1";
  stage.mV = -1;
  GateInputs in = raising(2);
  in.request.seq = 0;
  actuate(in, gated);
  EXPECT_EQ(stage.mV, 0);
  EXPECT_EQ(gated.measure().verdict, GateVerdict::NoRequest);
}

TEST_F(Actuate, WhatIsNotGivenIsNothing) {
  EXPECT_EQ(GateInputs{}.now_us, 0);
  EXPECT_EQ(GateInputs{}.writers, 0);
}

TEST_F(Actuate, UsesTheDriversClock) {
  actuate(raising(2), gated);
  GateInputs late = raising(3);
  late.permit.seq = 2;  // none arrived
  late.now_us = 2'000 + 5'000;
  actuate(late, gated);
  EXPECT_EQ(stage.mV, 0) << "a permit lives 5 ms";
  EXPECT_FALSE(stage.enabled);
}

}  // namespace
}  // namespace biopsy::robot
