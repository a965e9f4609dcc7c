// The voltage monitor, sample by sample and to the millivolt.
#include <gtest/gtest.h>

#include <cstdlib>
#include <tuple>

#include "tests/safety/monitor_bench.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

// What a fourth of four bad samples in a row would be: only the last one is judged here.
bool disagrees(std::int32_t before_mV, std::int32_t command_mV, std::int32_t monitor_mV,
               bool enabled = true) {
  VoltageBench bench(Mode::Active, enabled);
  bench.monitor.command_mV = before_mV;
  bench.monitor.disagree_score = kComes_goes * 2;
  bench.sample(command_mV, monitor_mV);
  return bench.names(Hazard::MonitorDisagrees);
}

TEST(VoltageMonitor, MonitorAndCommandMayDifferByThreePercentOfTheLargerOfTheLastTwoCommands) {
  verifies("R-08");
  for (const std::int32_t sign : {1, -1}) {
    EXPECT_FALSE(disagrees(sign * 6'000'000, sign * 6'000'000, sign * 6'180'000));
    EXPECT_TRUE(disagrees(sign * 6'000'000, sign * 6'000'000, sign * 6'180'001));
    EXPECT_FALSE(disagrees(sign * 6'000'000, sign * 6'000'000, sign * 5'820'000));
    EXPECT_TRUE(disagrees(sign * 6'000'000, sign * 6'000'000, sign * 5'819'999));
    EXPECT_FALSE(disagrees(sign * 6'000'000, sign * 6'000'000, 0, false)) << "not enabled";
  }
  for (const auto& [before_mV, command_mV] : {std::pair{1'000'000, 6'000'000}, {6'000'000, 1'000'000}}) {
    EXPECT_FALSE(disagrees(before_mV, command_mV, 820'000));
    EXPECT_TRUE(disagrees(before_mV, command_mV, 819'999));
    EXPECT_TRUE(disagrees(before_mV, command_mV, 0));
    EXPECT_FALSE(disagrees(before_mV, command_mV, 6'180'000));
    EXPECT_TRUE(disagrees(before_mV, command_mV, 6'180'001));
  }
}

TEST(VoltageMonitor, MonitorAndCommandMayAlwaysDifferByAHundredVolts) {
  verifies("R-08");
  EXPECT_FALSE(disagrees(0, 0, 100'000));
  EXPECT_TRUE(disagrees(0, 0, 100'001));
  EXPECT_FALSE(disagrees(0, 0, -100'000));
  EXPECT_TRUE(disagrees(0, 0, -100'001));
}

TEST(VoltageMonitor, MonitorAndCommandMayDifferForTwoSamples) {
  VoltageBench bench;
  for (const bool named : {false, false, true, true}) {
    bench.sample(0, 200'000);
    EXPECT_EQ(bench.names(Hazard::MonitorDisagrees), named);
  }
}

TEST(VoltageMonitor, OverVoltageIsAboveEightPointTwoKilovoltsTwice) {
  verifies("R-06");
  for (const std::int32_t sign : {1, -1}) {
    VoltageBench bench;
    for (int i = 0; i < 3; ++i) bench.sample(sign * 8'000'000, sign * 8'200'000);
    EXPECT_FALSE(bench.names(Hazard::OverVoltage));
    bench.sample(sign * 8'000'000, sign * 8'200'001);
    EXPECT_FALSE(bench.names(Hazard::OverVoltage));
    bench.sample(sign * 8'000'000, sign * 8'200'001);
    EXPECT_TRUE(bench.names(Hazard::OverVoltage));
  }
}

// A loose contact or a sparking joint: sound samples in between hide nothing, single spikes are none.
TEST(VoltageMonitor, WhatComesAndGoesInMoreThanAThirdOfTheSamplesAddsUp) {
  const auto named = [](Hazard hazard, int on, int off, std::int32_t monitor_mV, std::int32_t current_nA) {
    VoltageBench bench;
    bench.seen.measurement.command_mV = bench.monitor.command_mV = 4'000'000;
    for (int tick = 0; tick < 300; ++tick) {
      const bool shown = tick % (on + off) < on;
      bench.sample(4'000'000, shown ? monitor_mV : 4'000'000, shown ? current_nA : 0);
      if (bench.names(hazard)) return true;
    }
    return false;
  };
  for (const auto& [on, off] : {std::pair{2, 1}, {1, 1}, {2, 3}}) {
    EXPECT_TRUE(named(Hazard::MonitorDisagrees, on, off, 5'000'000, 0)) << on << " of " << on + off;
    EXPECT_TRUE(named(Hazard::Arc, on, off, 4'000'000, 5'000'000)) << on << " of " << on + off;
  }
  for (const auto& [on, off] : {std::pair{1, 2}, {1, 9}}) {
    EXPECT_FALSE(named(Hazard::MonitorDisagrees, on, off, 5'000'000, 0)) << on << " of " << on + off;
    EXPECT_FALSE(named(Hazard::Arc, on, off, 4'000'000, 5'000'000)) << on << " of " << on + off;
  }
}

// Two in a row are less than a fault, and a sound sample takes away what half a bad one adds.
TEST(VoltageMonitor, TwoBadSamplesASoundOneAndAThirdAreNoDisagreementAndAFourthIs) {
  verifies("R-08");
  VoltageBench bench;
  bench.sample(0, 0);
  for (const auto& [monitor_mV, named] :
       {std::pair{200'000, false}, {200'000, false}, {0, false}, {200'000, false}, {200'000, true}}) {
    bench.sample(0, monitor_mV);
    EXPECT_EQ(bench.names(Hazard::MonitorDisagrees), named);
  }
}

// A change of the command explains its charging current for the tick it was put out in and two more.
TEST(VoltageMonitor, ArcIsAMilliampereAboveWhatTheLastThreeChangesExplainTwice) {
  verifies("R-07");
  const auto is_arc = [](VoltageBench bench, std::int32_t command_mV, std::int32_t current_nA) {
    bench.monitor.arc_score = kComes_goes;
    bench.sample(command_mV, command_mV, current_nA);
    return bench.names(Hazard::Arc);
  };
  VoltageBench bench;
  const auto limit = [&](std::int32_t command_mV, std::int32_t limit_nA) {
    for (const std::int32_t sign : {1, -1}) {
      EXPECT_FALSE(is_arc(bench, command_mV, sign * limit_nA)) << limit_nA;
      EXPECT_TRUE(is_arc(bench, command_mV, sign * (limit_nA + 1))) << limit_nA;
    }
    bench.sample(command_mV, command_mV);
  };
  limit(0, 1'000'000);
  limit(1'000'000, 3'000'000);
  limit(1'000'000, 3'000'000);
  limit(1'000'000, 3'000'000);
  limit(1'000'000, 1'000'000);
  limit(-1'000'000, 5'000'000);
  limit(-700'000, 5'000'000);
  limit(-700'000, 5'000'000);
  limit(-700'000, 1'600'000);
  limit(-700'000, 1'000'000);
  bench.sample(-700'000, -700'000, 2'000'000);
  EXPECT_FALSE(bench.names(Hazard::Arc)) << "one sample";
  bench.sample(-700'000, -700'000, 2'000'000);
  EXPECT_TRUE(bench.names(Hazard::Arc));
}

TEST(VoltageMonitor, ObedienceAllowsTwoHundredVoltsAboveThePermitAndTwoTicksOfTransport) {
  verifies("R-09");
  for (const std::int32_t sign : {1, -1}) {
    VoltageBench bench;
    bench.seen.permit.v_max_mV = 1'000'000;
    for (int i = 0; i < 5; ++i) bench.sample(sign * 1'200'000, sign * 1'200'000);
    EXPECT_FALSE(bench.names(Hazard::DriverDisobeys));
    for (const bool named : {false, false, true, true}) {
      bench.sample(sign * 1'300'000, sign * 1'300'000);
      EXPECT_EQ(bench.names(Hazard::DriverDisobeys), named);
    }
    bench.monitor.disobey_ticks = 2;
    bench.sample(sign * 1'200'001, sign * 1'200'001);
    EXPECT_TRUE(bench.names(Hazard::DriverDisobeys));
  }
}

TEST(VoltageMonitor, ZeroVoltsTakeThreeQuietSamplesAndAreLostAtOnceByACommand) {
  verifies("R-01");
  VoltageBench bench(Mode::Ready, false);
  for (const bool zero : {false, false, true, true})
    EXPECT_EQ(bench.sample(100'000, -100'000).zero_volts, zero);
  EXPECT_FALSE(bench.sample(100'001, 0).zero_volts);
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(bench.sample(-100'001, 0).zero_volts);
  for (const bool zero : {false, false, true}) EXPECT_EQ(bench.sample(0, 0).zero_volts, zero);
}

TEST(VoltageMonitor, ZeroVoltsAreLostByTheMonitorAfterThreeSamples) {
  VoltageBench bench(Mode::Ready, false);
  for (int i = 0; i < 3; ++i) bench.sample(0, 0);
  for (const bool zero : {true, true, false, false}) EXPECT_EQ(bench.sample(0, 100'001).zero_volts, zero);
  for (const bool zero : {false, false, true}) EXPECT_EQ(bench.sample(0, 100'000).zero_volts, zero);
}

TEST(VoltageMonitor, ZeroVoltsHaveToBeShownAnewByAStageThatHadFallenSilent) {
  VoltageBench bench(Mode::Ready, false);
  for (int i = 0; i < 3; ++i) bench.sample(0, 0);
  EXPECT_FALSE(update(bench.plan, bench.monitor, bench.seen, false, true).zero_volts);
  for (const bool zero : {false, false, true}) EXPECT_EQ(bench.sample(0, 0).zero_volts, zero);
}

TEST(VoltageMonitor, ResidualChargeIsVoltageAtTheTwoHundredthMeasurementAfterSwitchingOff) {
  verifies("R-01");
  VoltageBench bench(Mode::Trip, false);
  for (int i = 1; i < 200; ++i) bench.sample(0, 150'000);
  EXPECT_FALSE(bench.names(Hazard::ResidualCharge));
  bench.sample(0, 150'000);
  EXPECT_TRUE(bench.names(Hazard::ResidualCharge));
  bench.sample(0, 150'000);
  EXPECT_TRUE(bench.names(Hazard::ResidualCharge));
  bench.sample(0, 0);
  EXPECT_FALSE(bench.names(Hazard::ResidualCharge));
  for (const bool named : {false, false, true}) {
    bench.sample(0, 150'000);
    EXPECT_EQ(bench.names(Hazard::ResidualCharge), named);
  }
}

TEST(VoltageMonitor, DriveIsReportedByItsAmountUpToItsLimit) {
  for (const std::int32_t drive_mV : {-9'000'000, -8'000'001, -2, -1, 0, 1, 2, 7'999'999, 9'000'000}) {
    VoltageBench bench;
    EXPECT_EQ(bench.sample(drive_mV, drive_mV).drive_mV, std::min(std::abs(drive_mV), 8'000'000));
  }
}

TEST(VoltageMonitor, ImagesAreDisturbedByAChangeOfMoreThanAHundredVoltsOrByAStageThatSaysNothing) {
  VoltageBench bench;
  bench.sample(1'000'000, 1'000'000);
  EXPECT_FALSE(bench.sample(-1'000'000, -1'000'000).image_disturbed) << "no image is being taken";
  bench.seen.acquiring = true;
  EXPECT_FALSE(bench.sample(-900'000, -900'000).image_disturbed);
  EXPECT_FALSE(bench.sample(-900'001, -900'001).image_disturbed);
  EXPECT_FALSE(bench.sample(-1'000'000, -1'000'000).image_disturbed);
  EXPECT_TRUE(bench.sample(-899'999, -899'999).image_disturbed);
  EXPECT_TRUE(bench.sample(-1'000'000, -1'000'000).image_disturbed);
  EXPECT_TRUE(update(bench.plan, bench.monitor, bench.seen, false, false).image_disturbed);
}

// A machine that stands still delivers in a burst what was measured before the permit changed.
TEST(VoltageMonitor, DriverIsComparedWithThePermitThatItAnsweredAsLongAsPermitsLive) {
  verifies("R-09");
  for (const auto& [age, named] : {std::pair{0U, true}, {1U, false}, {5U, false}, {6U, true}}) {
    VoltageBench bench;
    SupervisorInputs& seen = bench.seen;
    seen.permit.brake = seen.measurement.brake_on = true;
    for (seen.permit.seq = 1; seen.permit.seq <= 20; ++seen.permit.seq) {
      seen.measurement.answered_seq = seen.permit.seq;
      bench.sample(4'000'000, 4'000'000);
    }
    seen.permit.brake = false;
    for (int i = 0; i < 3; ++i) {  // the same delivery, since the permit with this number
      seen.measurement.answered_seq = seen.permit.seq - age;
      bench.sample(4'000'000, 4'000'000);
    }
    EXPECT_EQ(bench.names(Hazard::DriverDisobeys), named) << age;
    seen.measurement.answered_seq = 0;
    for (int i = 0; i < 3; ++i) bench.sample(4'000'000, 4'000'000);
    EXPECT_TRUE(bench.names(Hazard::DriverDisobeys)) << "an answer to none";
  }
}

// The first permits of a session: number 1 let the drive have 1 kV, those after it 4 kV. There is no number
// 0.
TEST(VoltageMonitor, DriverThatAnsweredNoPermitYetIsComparedWithTheNewest) {
  verifies("R-09");
  for (const auto& [answered, command_mV, named] :
       {std::tuple{0U, 4'000'000, false}, {1U, 4'000'000, true}, {2U, 4'000'000, false}}) {
    VoltageBench bench;
    for (std::uint32_t seq = 1; seq <= 4; ++seq) {
      bench.seen.permit.seq = seq;
      bench.seen.permit.v_max_mV = seq == 1 ? 1'000'000 : 4'000'000;
      bench.seen.measurement.answered_seq = answered;
      bench.sample(seq == 1 ? 0 : command_mV, seq == 1 ? 0 : command_mV);
    }
    EXPECT_EQ(bench.names(Hazard::DriverDisobeys), named) << answered;
  }
}

}  // namespace
}  // namespace biopsy::safety
