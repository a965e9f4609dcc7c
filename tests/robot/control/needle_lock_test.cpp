// The order in which brake and drive take over from each other.
#include "robot/control/needle_lock.hpp"

#include <gtest/gtest.h>

#include "robot/control/step_runner.hpp"

namespace biopsy::control {
namespace {

// A runner of one step at 2 mm that reached it and is held there.
struct HeldRunner {
  Plan plan;
  RunnerState state;
  Permit permit;
  double depth_mm = 2.0;
  bool hold_still = false, brake_fitted = true;

  HeldRunner() {
    for (const double depth : {2.0, 3.0}) {
      InsertionStep step;
      step.depth = Millimetres(depth);
      step.speed = MillimetresPerSecond(1.0);
      plan.steps.push_back(step);
    }
    state.loop.amplitude = Volts(4'000.0);
    state.setpoint = Millimetres(2.0);
    permit.hv_enable = true;
    hold();
  }
  void hold() {
    permit.mode = Mode::Hold, permit.slew_up_mV_per_tick = 0, permit.v_max_mV = 4'000'000;
    permit.brake = true;
  }
  void go_on(std::int32_t v_max_mV) {
    permit.mode = Mode::Active, permit.slew_up_mV_per_tick = 50'000, permit.v_max_mV = v_max_mV;
  }
  DriveRequest tick(std::uint32_t step = 0) {
    Measurement measurement;
    measurement.brake_fitted = brake_fitted;
    measurement.depth_um = to_um(Millimetres(depth_mm));
    const RunnerStep result =
        run_steps(plan, state, measurement, permit, {.step = step, .hold_still = hold_still});
    state = result.state;
    return result.request;
  }
  DriveRequest run(int ticks, std::uint32_t step = 0) {
    DriveRequest last;
    for (int i = 0; i < ticks; ++i) last = tick(step);
    return last;
  }
};

TEST(NeedleLock, GripsFirstAndTakesTheVoltageAwayAfterwards) {
  HeldRunner runner;
  EXPECT_FALSE(runner.run(50).brake);
  runner.hold_still = true;
  EXPECT_TRUE(runner.tick().brake);
  for (std::uint32_t i = 1; i < kGrip_ticks; ++i) ASSERT_EQ(std::abs(runner.tick().wanted_mV), 4'000'000);
  std::int32_t before_mV = 4'000'000;
  for (std::uint32_t i = 0; i < kUnload_ticks; ++i) {
    const DriveRequest request = runner.tick();
    ASSERT_TRUE(request.brake);
    ASSERT_LT(std::abs(request.wanted_mV), before_mV);
    before_mV = std::abs(request.wanted_mV);
  }
  EXPECT_EQ(before_mV, 0);
  runner.hold_still = false;
  const DriveRequest later = runner.run(60'000);
  EXPECT_TRUE(later.brake) << "the image is done: locked until the drive may rise again";
  EXPECT_EQ(later.wanted_mV, 0);
}

TEST(NeedleLock, LetsGoOnlyWhenTheStackPullsAsBeforeOnItsWayDown) {
  HeldRunner runner;
  runner.hold_still = true;
  runner.run(1'000);
  runner.hold_still = false;
  std::int32_t envelope_mV = 1'000'000, highest_mV = 0, last_mV = 0;
  int carrying = 0;
  bool brake = true;
  for (int i = 0; i < 4'000 && brake; ++i) {  // the supervisor's ceiling rises slowly
    envelope_mV = std::min(envelope_mV + 3'000, 5'200'000);
    runner.go_on(envelope_mV);
    const DriveRequest request = runner.tick(1);
    brake = request.brake;
    last_mV = std::abs(request.wanted_mV);
    carrying = last_mV == 4'000'000 && highest_mV > 5'000'000 ? carrying + 1 : 0;
    highest_mV = std::max(highest_mV, last_mV);
    ASSERT_LE(last_mV, envelope_mV);
    ASSERT_FALSE(request.step_reached);
  }
  EXPECT_FALSE(brake);
  EXPECT_EQ(highest_mV, to_mV(Volts(4'000.0) + kPast));
  EXPECT_EQ(last_mV, 4'000'000);
  EXPECT_EQ(carrying, static_cast<int>(kCarry_ticks));
  runner.go_on(8'000'000);
  const std::int32_t next_mV = std::abs(runner.tick(1).wanted_mV);
  EXPECT_NEAR(next_mV, 4'000'000, 30'000) << "taken over without a bump";
  runner.run(499, 1);
  EXPECT_NEAR(runner.state.setpoint.value, 2.5, 0.01) << "on its way to the next step";
}

TEST(NeedleLock, ANeedleThatSlippedIsBroughtBackAtTheStepsSpeed) {
  HeldRunner runner;
  runner.hold_still = true;
  runner.run(1'000);
  runner.depth_mm = 1.2;
  runner.go_on(4'000'000);
  while (runner.tick(1).brake) {
  }
  EXPECT_NEAR(runner.state.setpoint.value, 1.2, 1e-9);
  runner.run(100, 1);
  EXPECT_NEAR(runner.state.setpoint.value, 1.3, 1e-9);
}

TEST(NeedleLock, DoesNotWaitForEverForAnEnvelopeThatStaysBelow) {
  HeldRunner runner;
  runner.hold_still = true;
  runner.run(1'000);
  runner.go_on(3'000'000);
  std::uint32_t ticks = 1;
  while (runner.tick(1).brake) ++ticks;
  EXPECT_LE(ticks, kLiftMax_ticks);
  EXPECT_GE(ticks, kLiftMax_ticks - kCarry_ticks);
}

TEST(NeedleLock, ReleasingTheButtonBeforeTheDriveCarriesTheNeedleLocksItAnew) {
  HeldRunner runner;
  runner.hold_still = true;
  runner.run(1'000);
  runner.hold_still = false;
  runner.go_on(4'000'000);
  runner.run(100, 1);
  runner.hold();
  const DriveRequest held = runner.run(10, 1);
  EXPECT_TRUE(held.brake);
  EXPECT_EQ(held.wanted_mV, 0);
  runner.go_on(4'000'000);
  std::int32_t highest_mV = 0;
  for (bool brake = true; brake;) {
    const DriveRequest request = runner.tick(1);
    brake = request.brake;
    highest_mV = std::max(highest_mV, std::abs(request.wanted_mV));
  }
  EXPECT_EQ(highest_mV, 4'000'000) << "what carried it at first is remembered";
}

TEST(NeedleLock, NothingIsLockedWithoutPermissionOrWithoutHighVoltage) {
  HeldRunner runner;
  runner.hold_still = true;
  runner.permit.brake = false;
  EXPECT_FALSE(runner.run(500).brake);
  EXPECT_EQ(std::abs(runner.tick().wanted_mV), 4'000'000) << "an ordinary hold";
  runner.permit.brake = true;
  runner.brake_fitted = false;
  EXPECT_FALSE(runner.run(500).brake);
  EXPECT_EQ(std::abs(runner.tick().wanted_mV), 4'000'000) << "a stage without a brake keeps its voltage";
  runner.brake_fitted = true;
  EXPECT_TRUE(runner.run(500).brake);
  runner.permit.hv_enable = false;
  EXPECT_FALSE(runner.tick().brake);
}

// Ticks after the drive may rise until the brake lets go.
int ticks_until_let_go(HeldRunner& runner, std::int32_t v_max_mV) {
  runner.go_on(v_max_mV);
  int ticks = 1;
  while (runner.tick(1).brake) ++ticks;
  return ticks;
}

// As fast as it was taken away: all that carried the needle in 250 ms.
TEST(NeedleLock, BringsBackWhatCarriedTheNeedleInAQuarterOfASecond) {
  NeedleLock lock{.on = true, .carried = Volts(4'000.0)};
  Volts amplitude{0.0};
  for (int tick = 0; tick < 125; ++tick) lock = lift(lock, amplitude, Volts(8'000.0));
  EXPECT_NEAR(amplitude.value, 2'000.0, 1e-6);
  for (int tick = 0; tick < 125; ++tick) lock = lift(lock, amplitude, Volts(8'000.0));
  EXPECT_NEAR(amplitude.value, 4'000.0, 1e-6);
}

TEST(NeedleLock, LetsGoInTheTickThatItsTimesSay) {
  constexpr int kLiftMax = 5'000;
  // Below what carried it: the last kCarry ticks are for the retained charge, the first of them counts.
  // Above it but not past it: there is no time left for all of the way down and kCarry ticks.
  for (const auto& [v_max_mV, ticks] : {std::pair{3'000'000, kLiftMax - 1}, {5'000'000, kLiftMax}}) {
    HeldRunner runner;
    runner.hold_still = true;
    runner.run(1'000);
    EXPECT_EQ(ticks_until_let_go(runner, v_max_mV), ticks) << v_max_mV;
  }
  // What was waited before a release of the button is waited again.
  HeldRunner runner;
  runner.hold_still = true;
  runner.run(1'000);
  runner.go_on(3'000'000);
  runner.run(static_cast<int>(kLiftMax_ticks - 100), 1);
  runner.hold();
  runner.run(10, 1);
  EXPECT_EQ(ticks_until_let_go(runner, 3'000'000), kLiftMax - 1);
}

TEST(NeedleLock, IsLiftedPastWhatCarriedItEachTimeAndNoFasterThanItWasUnloaded) {
  HeldRunner runner;
  runner.hold_still = true;
  for (int round = 0; round < 2; ++round) {
    runner.hold();
    runner.run(1'000);
    runner.go_on(8'000'000);
    std::int32_t highest_mV = 0;
    for (int i = 0; i < 400; ++i) {
      const std::int32_t now_mV = std::abs(runner.tick(1).wanted_mV);
      ASSERT_LE(now_mV - highest_mV, 4'000'000 / static_cast<std::int32_t>(kUnload_ticks) + 1) << i;
      highest_mV = std::max(highest_mV, now_mV);
    }
    EXPECT_EQ(highest_mV, to_mV(Volts(4'000.0) + kPast)) << round;
  }
}

TEST(NeedleLock, RemembersWhatTheEnvelopeLetCarryTheNeedle) {
  HeldRunner runner;
  runner.hold_still = true;
  runner.permit.v_max_mV = 3'000'000;
  runner.tick();
  EXPECT_EQ(runner.state.lock.carried, Volts(3'000.0));
}

TEST(NeedleLock, WhileItGripsTheDriveIsNotRegulated) {
  HeldRunner runner;
  runner.hold_still = true;
  runner.tick();
  runner.depth_mm = 2.4;  // beyond the step, where an ordinary hold would lower the drive
  for (std::uint32_t i = 1; i < kGrip_ticks; ++i)
    ASSERT_EQ(std::abs(runner.tick().wanted_mV), 4'000'000) << i;
}

TEST(NeedleLock, APermitWithoutTheBrakeOpensItAndDrives) {
  HeldRunner runner;
  runner.hold_still = true;
  runner.run(1'000);
  runner.go_on(8'000'000);
  runner.permit.brake = false;
  EXPECT_FALSE(runner.tick(1).brake);
  EXPECT_FALSE(runner.state.lock.on);
  EXPECT_GT(runner.state.setpoint, Millimetres(2.0));
}

}  // namespace
}  // namespace biopsy::control
