// Voltage, polarity, depth and ramp in the loop of supervisor and gate.
#include <gtest/gtest.h>

#include "tests/safety/rig.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

TEST(SafetyLoop, VoltageThatAppearsWhileReadyTripsInThreeTicks) {
  verifies("R-36");
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.on_measurement = [](Measurement& m) { m.monitor_mV = -150'000; };
  EXPECT_EQ(rig.ticks_until([&] { return rig.state.mode == Mode::Trip; }, 10), 3);
  EXPECT_EQ(rig.state.last_event, Event::VoltagePresent);
}

TEST(SafetyLoop, VoltageCommandedWithoutShowingOnTheMonitorIsNotZero) {
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.on_measurement = [](Measurement& m) { m.command_mV = 150'000; };
  rig.tick();
  EXPECT_EQ(rig.state.mode, Mode::Trip);
}

TEST(SafetyLoop, VoltageIsUnknownWhenTheStageFallsSilent) {
  verifies("R-18");
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.on_measurement = [old = rig.measurement](Measurement& m) { m = old; };
  EXPECT_EQ(rig.ticks_until([&] { return rig.state.mode == Mode::Trip; }, 10), 4);
}

TEST(SafetyLoop, PolarityBalanceIsJudgedInAHoldTooAndForgottenWhenTheDriveWasOff) {
  verifies("R-22");
  Rig rig;
  rig.on_request = [tick = 0](DriveRequest& q) mutable {  // positive in nine tenths of each period
    q.wanted_mV = (tick++ % 500 < 440 ? 1 : -1) * std::abs(q.wanted_mV);
  };
  ASSERT_TRUE(rig.go_armed());
  rig.press();
  rig.run(600);
  ASSERT_EQ(rig.state.mode, Mode::Active);
  rig.release();
  ASSERT_LE(rig.ticks_until([&] { return rig.state.mode == Mode::Hold; }, 200), 200);
  EXPECT_EQ(rig.evidence.hazards(), 0U);
  EXPECT_LE(rig.ticks_until([&] { return rig.output.worst == Hazard::PolarityStuck; }, 600), 600);
  EXPECT_EQ(rig.state.mode, Mode::Retract);
  rig.on_request = [](DriveRequest&) {};
  ASSERT_LE(rig.ticks_until([&] { return rig.state.mode == Mode::Ready; }, 400), 400);
  EXPECT_EQ(rig.state.reason, Hazard::None);
  ASSERT_TRUE(rig.go_active()) << "a new procedure starts without the old balance";
}

TEST(SafetyLoop, PolarityAWaveWithoutAmplitudeOrOutsideActiveIsNotJudged) {
  Rig rig;
  rig.flip_ticks = 60;
  rig.wanted_mV = 900'000;
  ASSERT_TRUE(rig.go_active());
  rig.wanted_mV = 3'000'000;
  EXPECT_LE(rig.ticks_until([&] { return rig.output.worst == Hazard::WrongFrequency; }, 1'000), 400);
}

TEST(SafetyLoop, DepthIsJudgedByWhereTheNeedleWouldComeToRest) {
  verifies("R-14", "R-16");
  Rig rig;
  rig.wanted_mV = 5'000'000;
  ASSERT_TRUE(rig.go_active());
  std::int32_t seen_um = 0;
  rig.on_measurement = [&, um = 0](Measurement& m) mutable { seen_um = m.depth_um += um += 50; };  // 50 mm/s
  EXPECT_LE(rig.ticks_until([&] { return (rig.evidence.hazards() & bit(Hazard::OverDepth)) != 0; }, 40), 40);
  EXPECT_LT(seen_um, rig.plan.depth_max_um - 300) << "50 mm/s need 0.25 mm to react and 0.25 mm to stop";
}

TEST(SafetyLoop, DepthACodeThatStaysTheSameAtASteadyVoltageIsNotFrozen) {
  verifies("R-19");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_measurement = [old = rig.measurement](Measurement& m) {
    m.laser_code = old.laser_code, m.depth_um = old.depth_um;
  };
  rig.run(600);
  EXPECT_EQ(rig.state.mode, Mode::Active) << name_of(rig.state.reason);
}

TEST(SafetyLoop, RampStartsAtThePresentVoltageAndFallsInAStraightLine) {
  verifies("R-37");
  Rig rig;
  ASSERT_TRUE(rig.go_retract());
  EXPECT_EQ(rig.output.permit.v_max_mV, 6'000'000);
  rig.run(125);
  EXPECT_EQ(rig.output.permit.v_max_mV, 3'000'000);
  EXPECT_LE(std::abs(rig.gate_state.drive_mV), 3'000'000);
  rig.run(100);
  EXPECT_EQ(rig.output.permit.v_max_mV, 600'000);
}

TEST(SafetyLoop, APlanInTheWrongUnitsIsNeverReady) {
  verifies("R-29");
  Rig rig;
  rig.plan.depth_max_um = 4;
  rig.run(200);
  EXPECT_EQ(rig.state.mode, Mode::Safe);
  EXPECT_NE(rig.evidence.hazards() & bit(Hazard::PlanImplausible), 0U);
}

}  // namespace
}  // namespace biopsy::safety
