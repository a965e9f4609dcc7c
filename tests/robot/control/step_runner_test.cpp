// The runner asks for what the plan and the permit say, tick by tick.
#include "robot/control/step_runner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

namespace biopsy::control {
namespace {

Plan plan_of(std::vector<InsertionStep> steps) {
  Plan plan;
  plan.steps = std::move(steps);
  return plan;
}

InsertionStep step(double depth_mm, double speed_mm_s, double dwell_s = 0.0) {
  InsertionStep made;
  made.depth = Millimetres(depth_mm);
  made.speed = MillimetresPerSecond(speed_mm_s);
  made.dwell = Seconds(dwell_s);
  return made;
}

Permit raising(std::int32_t v_max_mV = 8'000'000) {
  Permit permit;
  permit.hv_enable = true;
  permit.v_max_mV = v_max_mV;
  permit.slew_up_mV_per_tick = 80'000;
  permit.mode = Mode::Active;
  permit.stop = StopCategory::None;
  return permit;
}

Permit holding(std::int32_t v_max_mV = 8'000'000) {
  Permit permit = raising(v_max_mV);
  permit.slew_up_mV_per_tick = 0;
  permit.mode = Mode::Hold;
  permit.stop = StopCategory::C2Hold;
  return permit;
}

// A runner and the plan it drives; each tick sees the given depth.
struct Bench {
  Plan plan = plan_of({step(2.0, 2.0, 0.1), step(3.5, 1.0, 0.1)});
  PiGains gains;
  RunnerState state;

  DriveRequest tick(double depth_mm, const Permit& permit, std::uint32_t step_index = 0,
                    bool finish = false) {
    Measurement measurement;
    measurement.depth_um = to_um(Millimetres(depth_mm));
    const RunnerStep result =
        run_steps(plan, state, measurement, permit, {.step = step_index, .finish = finish});
    state = result.state;
    return result.request;
  }
  std::int32_t amplitude_mV() const { return to_mV(state.loop.amplitude); }
};

TEST(StepRunner, SetpointWalksAtTheStepsSpeedAndStopsAtItsDepth) {
  Bench bench;
  for (int k = 1; k <= 3000; ++k) {
    const Millimetres before = bench.state.setpoint;
    bench.tick(0.0, raising());
    ASSERT_LE(bench.state.setpoint - before, Millimetres(0.002 + 1e-12));
    ASSERT_NEAR(bench.state.setpoint.value, std::min(0.002 * k, 2.0), 1e-9);
  }
}

TEST(StepRunner, TheNextStepWalksOnAtItsOwnSpeed) {
  Bench bench;
  for (int k = 0; k < 2000; ++k) bench.tick(0.002 * k, raising());
  bench.tick(2.0, raising(), 1);
  EXPECT_NEAR(bench.state.setpoint.value, 2.001, 1e-9);
  EXPECT_EQ(bench.tick(2.0, raising(), 1).step, 1U);
}

TEST(StepRunner, StartsFromWhereTheNeedleRests) {
  Bench bench;
  Permit off;
  off.hv_enable = false;
  bench.tick(0.3, off);
  EXPECT_DOUBLE_EQ(bench.state.setpoint.value, 0.3);
  bench.tick(0.3, raising());
  EXPECT_NEAR(bench.state.setpoint.value, 0.302, 1e-12);
  bench.tick(-0.2, off);
  EXPECT_EQ(bench.state.setpoint, Millimetres(0));  // no setpoint outside the patient
}

TEST(StepRunner, AsksForZeroAndForgetsItsIntegralWhenNotEnabled) {
  Bench bench;
  for (int k = 0; k < 800; ++k) bench.tick(0.0, raising());
  ASSERT_GT(bench.amplitude_mV(), 1'000'000);
  Permit off = raising();  // all but the one bit
  off.hv_enable = false;
  EXPECT_EQ(bench.tick(0.5, off).wanted_mV, 0);
  EXPECT_EQ(bench.state.loop.integral, Volts(0));
  EXPECT_EQ(bench.state.drive_ticks, 0U);
}

TEST(StepRunner, AlternatesPolarityEveryQuarterSecondOfDrive) {
  Bench bench;
  for (int k = 0; k < 1000; ++k) {
    const DriveRequest request = bench.tick(0.0, raising());
    ASSERT_EQ(request.wanted_mV > 0, (k / 250) % 2 == 0) << k;
  }
}

TEST(StepRunner, NeverAsksForMoreThanThePermitsEnvelope) {
  Bench bench;
  for (int k = 0; k < 3000; ++k)
    ASSERT_LE(std::abs(bench.tick(0.0, raising(1'500'000)).wanted_mV), 1'500'000);
  EXPECT_EQ(bench.amplitude_mV(), 1'500'000);
}

TEST(StepRunner, HoldNeverRaisesWhateverTheNeedleDoes) {
  Bench bench;
  for (int k = 0; k < 800; ++k) bench.tick(0.5, raising());
  std::int32_t before = bench.amplitude_mV();
  ASSERT_GT(before, 0);
  for (int k = 0; k < 3000; ++k) {
    bench.tick(2.0 + 1.5 * std::sin(0.01 * k), holding());
    ASSERT_LE(bench.amplitude_mV(), before) << k;
    before = bench.amplitude_mV();
  }
}

TEST(StepRunner, HoldKeepsTheAmplitudeOfANeedleThatStandsWhereItShould) {
  Bench bench;
  for (int k = 0; k < 1200; ++k) bench.tick(0.5, raising());
  const std::int32_t before = bench.amplitude_mV();
  for (int k = 0; k < 5000; ++k)
    bench.tick(2.0 + 0.04 * (k % 2 == 0 ? 1 : -1), holding());  // noise of the laser
  EXPECT_EQ(bench.amplitude_mV(), before);
}

TEST(StepRunner, HoldLetsANeedleBackThatJumpedBeyondItsStep) {
  Bench bench;
  for (int k = 0; k < 1200; ++k) bench.tick(0.5, raising());
  const std::int32_t before = bench.amplitude_mV();
  bench.tick(2.6, holding());
  EXPECT_LT(bench.amplitude_mV(), before);
}

TEST(StepRunner, HoldFollowsAFallingEnvelope) {
  Bench bench;
  for (int k = 0; k < 1200; ++k) bench.tick(0.5, raising());
  ASSERT_GT(bench.amplitude_mV(), 1'000'000);
  EXPECT_EQ(std::abs(bench.tick(2.0, holding(700'000)).wanted_mV), 700'000);
  bench.tick(2.0, holding());
  EXPECT_EQ(bench.amplitude_mV(), 700'000);  // and does not come back up
}

TEST(StepRunner, ResumesFromAHoldWithoutABump) {
  Bench bench;
  for (int k = 0; k < 1100; ++k) bench.tick(0.002 * k - 0.1, raising());
  for (int k = 0; k < 500; ++k) bench.tick(1.9, holding());
  const std::int32_t held = bench.amplitude_mV();
  bench.tick(1.9, raising());
  // No more than what the setpoint's stride and one tick of the integral ask for: 0.8 kV/mm x 2 um + 5 V/mm x
  // 0.1 mm.
  EXPECT_NEAR(bench.amplitude_mV(), held, 1'600 + 600);
}

TEST(StepRunner, IsReachedOnlyAfterTheDwellWithoutABreak) {
  Bench bench;
  for (int k = 0; k < 950; ++k) bench.tick(0.002 * k, raising());  // up to 1.9 mm
  for (int k = 0; k < 99; ++k) ASSERT_FALSE(bench.tick(2.03, raising()).step_reached);
  ASSERT_FALSE(bench.tick(2.22, raising()).step_reached);  // one reading outside kReadingOff begins anew
  for (int k = 0; k < 99; ++k) ASSERT_FALSE(bench.tick(2.03, raising()).step_reached) << k;
  int later = 0;  // until the mean, too, has stood still for the dwell
  while (!bench.tick(2.03, raising()).step_reached && later < 1000) ++later;
  EXPECT_LT(later, 150);
  EXPECT_TRUE(bench.tick(2.5, raising()).step_reached);      // latched,
  EXPECT_FALSE(bench.tick(2.5, raising(), 1).step_reached);  // until the stage changes
}

// The laser of the paper's class: 27 um, normal. By single readings within 0.05 mm a dwell of 0.1 s would
// never end.
TEST(StepRunner, IsReachedUnderTheNoiseOfTheLaser) {
  std::mt19937 random(7);
  std::normal_distribution<double> laser(0.0, 0.027);
  for (const double off : {-0.04, 0.0, 0.04}) {
    Bench bench;
    int ticks = 0;
    while (!bench.tick(2.0 + off + laser(random), raising()).step_reached && ticks < 2000) ++ticks;
    EXPECT_LT(ticks, 600) << off;
  }
}

TEST(StepRunner, IsNotReachedByANeedleThatOscillatesAboutTheDepth) {
  Bench bench;
  for (int k = 0; k < 5000; ++k)
    ASSERT_FALSE(bench.tick(2.0 + 0.3 * std::sin(0.2 * k), raising()).step_reached) << k;
}

// Held beyond its depth by friction, and sliding back through it: in the hold it would go on.
TEST(StepRunner, IsNotReachedByANeedleThatSlidesThroughTheDepth) {
  Bench bench;
  for (int k = 0; k < 1000; ++k)
    ASSERT_FALSE(bench.tick(2.2 - 0.0004 * k, raising()).step_reached) << k;  // 0.4 mm/s
}

TEST(StepRunner, TimeInAHoldDoesNotCountAsDwell) {
  Bench bench;
  for (int k = 0; k < 50; ++k) bench.tick(2.0, raising());
  for (int k = 0; k < 1000; ++k) ASSERT_FALSE(bench.tick(2.0, holding()).step_reached);
}

TEST(StepRunner, NumbersEveryRequestAndPassesTheOperatorsWishOn) {
  Bench bench;
  EXPECT_EQ(bench.tick(0.0, raising()).seq, 1U);
  EXPECT_EQ(bench.tick(0.0, holding()).seq, 2U);
  EXPECT_EQ(bench.tick(0.0, Permit{}).seq, 3U);
  EXPECT_FALSE(bench.tick(0.0, raising()).finished);
  EXPECT_TRUE(bench.tick(0.0, raising(), 0, true).finished);
}

TEST(StepRunner, SameInputsSameRequests) {
  const auto requests = [] {
    Bench bench;
    std::vector<std::int32_t> out;
    for (int k = 0; k < 2000; ++k)
      out.push_back(
          bench.tick(1e-3 * k + 0.01 * std::sin(k), k % 700 < 600 ? raising() : holding()).wanted_mV);
    return out;
  };
  EXPECT_EQ(requests(), requests());
}

// Two steps to one depth: the needle stands, only the step changes.
Bench standing_at_step_one() {
  Bench bench;
  bench.plan = plan_of({step(2.0, 2.0, 0.1), step(2.0, 2.0, 0.1)});
  for (int k = 0; k < 1'000; ++k) bench.tick(0.002 * k, raising());
  for (int k = 0; k < 600; ++k) bench.tick(2.0, raising());
  return bench;
}

int ticks_until_reached(Bench& bench, double depth_mm, std::uint32_t step_index) {
  int ticks = 1;
  while (!bench.tick(depth_mm, raising(), step_index).step_reached && ticks < 5'000) ++ticks;
  return ticks;
}

TEST(StepRunner, EachStepHasItsWholeDwellWhicheverStepWasBefore) {
  Bench bench = standing_at_step_one();
  const std::uint32_t before = bench.state.seq;
  EXPECT_EQ(ticks_until_reached(bench, 2.0, 1), 100);
  EXPECT_EQ(bench.state.seq, before + 100);
  EXPECT_EQ(ticks_until_reached(bench, 2.0, 0), 100) << "back to an earlier step";
}

TEST(StepRunner, AReadingFarOffBeginsTheDwellAnew) {
  Bench bench = standing_at_step_one();
  for (int k = 0; k < 90; ++k) ASSERT_FALSE(bench.tick(2.0, raising(), 1).step_reached);
  bench.tick(2.5, raising(), 1);  // moves the mean by 8 um only
  EXPECT_EQ(ticks_until_reached(bench, 2.0, 1), 100);
}

// Edges of what counts as noise and as standing still, from their definitions: 0.21 mm and 15 um.
TEST(StepRunner, AReadingWithinItsNoiseDoesNotBeginTheDwellAnewAndOneBesideDoes) {
  for (const double sign : {1.0, -1.0})
    for (const auto& [off_mm, later] : {std::pair{0.209, 9}, {0.212, 100}}) {
      Bench bench = standing_at_step_one();
      for (int k = 0; k < 90; ++k) ASSERT_FALSE(bench.tick(2.0, raising(), 1).step_reached);
      bench.tick(2.0 + sign * off_mm, raising(), 1);
      EXPECT_EQ(ticks_until_reached(bench, 2.0, 1), later) << sign * off_mm;
    }
}

TEST(StepRunner, AMeanThatMovesByMoreThanFifteenMicrometresBeginsTheDwellAnew) {
  for (const double sign : {1.0, -1.0}) {
    const auto ticks_at = [&](double off_mm) {
      Bench bench = standing_at_step_one();
      bench.plan = plan_of({step(2.0, 2.0, 0.1), step(2.0, 2.0, 1.0)});
      bench.state.settled_at = bench.state.mean_error = Millimetres(0.0);
      return ticks_until_reached(bench, 2.0 + sign * off_mm, 1);
    };
    EXPECT_EQ(ticks_at(0.014), 1'000);
    // A mean over 64 ticks comes by 15 of 17 um in 64 ln(17 / 2) = 137.
    EXPECT_NEAR(ticks_at(0.017), 1'137, 5);
    EXPECT_LT(ticks_at(0.049), 1'500);
    EXPECT_EQ(ticks_at(0.052), 5'000) << "never";
  }
}

TEST(StepRunner, IsNotReachedByANeedleThatCreepsOutOfTheBand) {
  Bench bench;
  bench.plan = plan_of({step(2.0, 2.0, 0.1), step(2.0, 2.0, 2.0)});
  for (int k = 0; k < 1'600; ++k) bench.tick(std::min(0.002 * k, 1.957), raising());
  for (int k = 0; k < 1'500; ++k) ASSERT_FALSE(bench.tick(1.957, raising(), 1).step_reached);
  for (int k = 0; k < 1'500; ++k) ASSERT_FALSE(bench.tick(1.945, raising(), 1).step_reached) << k;
}

TEST(StepRunner, HoldLetsANeedleBackThatStandsALittleBeyondItsStepForLong) {
  Bench bench;
  for (int k = 0; k < 1'200; ++k) bench.tick(2.0, raising());
  bench.state.loop.amplitude = Volts(4'000.0);
  bench.tick(2.1, holding());
  EXPECT_EQ(bench.amplitude_mV(), 4'000'000) << "one reading may be noise";
  for (int k = 0; k < 300; ++k) bench.tick(2.1, holding());
  EXPECT_LT(bench.amplitude_mV(), 4'000'000);
}

// 0.06 mm: kSettled, and what the mean leaves of the noise.
TEST(StepRunner, HoldLetsANeedleBackWhoseMeanIsSixHundredthsBeyondItsStep) {
  for (const auto& [off_mm, is_let_back] : {std::pair{0.059, false}, {0.061, true}}) {
    Bench bench;
    for (int k = 0; k < 1'200; ++k) bench.tick(2.0, raising());
    bench.state.loop.amplitude = Volts(4'000.0);
    bench.state.mean_error = Millimetres(-off_mm);
    for (int k = 0; k < 50; ++k) bench.tick(2.0 + off_mm, holding());
    EXPECT_EQ(bench.amplitude_mV() < 4'000'000, is_let_back) << off_mm;
  }
}

TEST(StepRunner, IsAtRestBeforeItsFirstTickAndAsksForNothing) {
  const RunnerState state;
  EXPECT_EQ(state.settled_ticks, 0U);
  EXPECT_EQ(state.seq, 0U);
  EXPECT_EQ(state.drive_ticks, 0U);
  EXPECT_EQ(state.step, 0U);
  EXPECT_FALSE(state.raising || state.reached);
  const Task task;
  EXPECT_EQ(task.step, 0U);
  EXPECT_FALSE(task.hold_still || task.finish);
}

TEST(StepRunner, ReachedStaysReachedWhenTheVoltageIsOff) {
  Bench bench = standing_at_step_one();
  Permit off;
  off.hv_enable = false;
  EXPECT_TRUE(bench.tick(2.0, off).step_reached);
}

TEST(StepRunner, BeginsWithoutABumpAfterTheVoltageWasOff) {
  Bench bench;
  for (int k = 0; k < 800; ++k) bench.tick(0.0, raising());
  Permit off;
  off.hv_enable = false;
  bench.tick(0.3, off);
  EXPECT_FALSE(bench.state.raising);
  bench.tick(0.1, raising());  // settled by 0.2 mm before the first tick of the drive
  EXPECT_LT(bench.amplitude_mV(), 10'000) << "the stride and a tick of the integral";
}

TEST(StepRunner, AnswersANeedleThatFallsBackInProportionWhileItRaises) {
  Bench bench;
  for (int k = 0; k < 500; ++k) bench.tick(0.0, raising());
  const std::int32_t before = bench.amplitude_mV();
  bench.tick(-0.1, raising());
  EXPECT_NEAR(bench.amplitude_mV() - before, 0.1e3 * bench.gains.proportional_V_per_mm, 10'000);
}

TEST(StepRunner, RaisesWithAnySlewAndWithNoneItHolds) {
  for (const auto& [slew_mV, raises] : {std::pair{1, true}, {0, false}, {-1, false}}) {
    Bench bench;
    bench.state.loop.amplitude = Volts(1'000.0);
    Permit permit = raising();
    permit.slew_up_mV_per_tick = slew_mV;
    for (int k = 0; k < 100; ++k) bench.tick(0.0, permit);
    EXPECT_EQ(bench.state.setpoint > Millimetres(0), raises) << slew_mV;
  }
}

TEST(StepRunner, SaysWhatItMeasuredLastAndWhereItsSetpointIs) {
  Bench bench;
  Measurement measurement;
  measurement.seq = 77, measurement.answer = 78;
  bench.state.setpoint = Millimetres(1.2);
  const RunnerStep result = run_steps(bench.plan, bench.state, measurement, holding(), {});
  EXPECT_EQ(result.request.measured_seq, 77U);
  EXPECT_EQ(result.request.setpoint_um, 1'200);
}

}  // namespace
}  // namespace biopsy::control
