// A plan for the bench may declare another rate of polarity than 2 Hz; nothing else becomes looser.
#include <gtest/gtest.h>

#include "safety/monitors/debounce.hpp"
#include "safety/types/thresholds.hpp"
#include "tests/safety/rig.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

Rig bench_rig(std::int32_t declared, std::int32_t real) {
  Rig rig;
  rig.plan.bench_half_period_ticks = declared;
  rig.flip_ticks = real;
  rig.on_observation = [](SupervisorInputs& seen) { seen.bench_confirmed = true; };
  return rig;
}

TEST(BenchPlan, IsEveryPlanWithAHalfPeriodOfItsOwnEvenOneBelowZero) {
  verifies("R-29", "R-30");
  for (const std::int32_t half_period_ticks : {-1, 100}) {
    Rig rig;
    rig.plan.bench_half_period_ticks = half_period_ticks;
    rig.run(50);
    const HazardSet implausible = when(half_period_ticks < 0, Hazard::PlanImplausible);
    EXPECT_EQ(rig.evidence.hazards(), implausible | bit(Hazard::PlanUnconfirmed)) << half_period_ticks;
  }
}

TEST(BenchPlan, MayChangePolarityAtTheRateItDeclares) {
  for (const std::int32_t half_period :
       {kBenchHalfPeriodMin_ticks, 100, 250, 1'000, kBenchHalfPeriodMax_ticks}) {
    Rig rig = bench_rig(half_period, half_period);
    ASSERT_TRUE(rig.go_active()) << half_period;
    rig.run(12 * half_period + 5'000);
    EXPECT_EQ(rig.state.mode, Mode::Active) << half_period << ": " << name_of(rig.state.reason);
  }
}

TEST(BenchPlan, IsHeldToTheRateItDeclares) {
  verifies("R-23");
  for (const auto& [declared, real] :
       {std::pair{100, 250}, {1'000, 250}, {250, 100}, {100, 78}, {100, 123}}) {
    Rig rig = bench_rig(declared, real);
    ASSERT_TRUE(rig.go_armed());
    rig.press();
    EXPECT_LE(rig.ticks_until([&] { return rig.output.worst == Hazard::WrongFrequency; }, 3'000), 3'000)
        << declared << " declared, " << real << " driven";
    EXPECT_EQ(rig.state.mode, Mode::Retract);
  }
}

TEST(BenchPlan, WithAStuckPolarityEndsAfterSixHalfPeriods) {
  verifies("R-22");
  for (const std::int32_t half_period : {250, 1'000, kBenchHalfPeriodMax_ticks}) {
    Rig rig = bench_rig(half_period, 1'000'000);
    ASSERT_TRUE(rig.go_armed());
    rig.press();
    const int ticks = rig.ticks_until([&] { return rig.state.mode == Mode::Retract; }, 20'000);
    EXPECT_LE(ticks, 6 * half_period) << half_period;
    EXPECT_EQ(rig.state.reason, Hazard::PolarityStuck);
  }
}

TEST(BenchPlan, ThatIsFasterThanTheBenchAllowsStillEndsAStuckPolarityAsSoonAsAnyPlan) {
  Rig rig = bench_rig(kBenchHalfPeriodMin_ticks, 1'000'000);
  ASSERT_TRUE(rig.go_armed());
  rig.press();
  EXPECT_LE(rig.ticks_until([&] { return rig.state.mode == Mode::Retract; }, 20'000), 1'500);
}

TEST(BenchPlan, IsNeverReadyUnlessSomebodySaysNoPatientNoNeedle) {
  verifies("R-30");
  Rig rig = bench_rig(100, 100);
  rig.on_observation = [](SupervisorInputs&) {};
  EXPECT_FALSE(rig.go_ready());
  EXPECT_EQ(rig.output.worst, Hazard::PlanUnconfirmed);
  EXPECT_FALSE(SupervisorInputs{}.bench_confirmed) << "absence means no";
}

TEST(BenchPlan, EndsWhenTheConfirmationIsTakenBack) {
  Rig rig = bench_rig(100, 100);
  ASSERT_TRUE(rig.go_active());
  rig.on_observation = [](SupervisorInputs&) {};
  rig.tick();
  EXPECT_EQ(rig.state.mode, Mode::Retract);
  EXPECT_EQ(rig.state.reason, Hazard::PlanUnconfirmed);
}

TEST(BenchPlan, ConfirmationOpensNothingForAPlanWithAPatient) {
  Rig rig = bench_rig(0, 100);
  ASSERT_TRUE(rig.go_armed());
  rig.press();
  EXPECT_LE(rig.ticks_until([&] { return rig.output.worst == Hazard::WrongFrequency; }, 3'000), 3'000);
}

TEST(BenchPlan, OutsideTheRatesOfTheBenchIsRefusedAndJudgedAtTwoHertz) {
  for (const std::int32_t declared :
       {-250, -1, 1, kBenchHalfPeriodMin_ticks - 1, kBenchHalfPeriodMax_ticks + 1, 1'000'000}) {
    Rig rig = bench_rig(declared, 250);
    EXPECT_FALSE(is_plausible(rig.plan)) << declared;
    EXPECT_EQ(half_period_ticks(rig.plan), kHalfPeriod_ticks) << declared;
    EXPECT_FALSE(rig.go_ready()) << declared;
    EXPECT_EQ(rig.output.worst, Hazard::PlanImplausible) << declared;
  }
}

TEST(BenchPlan, IsWatchedLikeAnyOther) {
  Rig rig = bench_rig(100, 100);
  ASSERT_TRUE(rig.go_active());
  rig.push_um = 3'000;  // beyond the plan's depth
  EXPECT_LE(rig.ticks_until([&] { return rig.state.mode != Mode::Active; }, 10), 10);
}

}  // namespace
}  // namespace biopsy::safety
