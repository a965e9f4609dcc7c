#include "planner/plan/open_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "planner/plan/seal.hpp"

namespace biopsy::planner {
namespace {

Plan sealed_plan(bool bench) {
  Plan plan;
  plan.target = {"P-7", "1.2.840.1", Point(1, 2, 3), Point(4, 5, 6.5)};
  plan.X_SR.translation() = Point(10, 20, 30);
  plan.registration_fre_mm = 0.25;
  plan.target_depth = Millimetres(3.5);
  plan.layers = {{"gap", Millimetres(0), Millimetres(1)}, {"liver", Millimetres(1), Millimetres(9)}};
  plan.steps = {{StepKind::Approach, Millimetres(0.5), MillimetresPerSecond(2), Volts(5000), Seconds(0.2),
                 false, "stop short"},
                {StepKind::Target, Millimetres(3.5), MillimetresPerSecond(0.5), Volts(6000), Seconds(1.0),
                 true, "target in liver"}};
  plan.limits = {Millimetres(4.5), Volts(6000), {{Volts(500), Millimetres(-0.5), Millimetres(4)}}};
  if (bench) plan.bench = BenchDrive{Seconds(0.5)};
  seal(plan);
  return plan;
}

TEST(OpenPlan, GivesBackWhatWasSealed) {
  for (const bool bench : {false, true}) {
    const Plan plan = sealed_plan(bench);
    const std::vector<std::uint8_t> bytes = canonical_bytes(plan);
    const std::optional<Plan> opened = open_plan(bytes, plan.seal);
    ASSERT_TRUE(opened);
    EXPECT_EQ(canonical_bytes(*opened), bytes);
    EXPECT_EQ(opened->steps[1].why, "target in liver");
    EXPECT_EQ(opened->bench.has_value(), bench);
    EXPECT_TRUE(seal_holds(*opened));
  }
}

TEST(OpenPlan, GivesBackTheGainsOfTheLoop) {
  for (const bool bench : {false, true}) {
    Plan plan = sealed_plan(bench);
    plan.gains = {.proportional_V_per_mm = 612.5, .integral_V_per_mm_per_tick = 7.25};
    seal(plan);
    const std::optional<Plan> opened = open_plan(canonical_bytes(plan), plan.seal);
    ASSERT_TRUE(opened);
    EXPECT_EQ(opened->gains, plan.gains);
    EXPECT_EQ(opened->bench.has_value(), bench);
  }
}

TEST(OpenPlan, RefusesGainsThatAreNotPermitted) {
  for (const PiGains gains : {PiGains{4001.0, 5.0}, PiGains{49.0, 5.0}, PiGains{800.0, 0.1},
                              PiGains{800.0, 51.0}, PiGains{-800.0, 5.0}, PiGains{800.0, -5.0}}) {
    Plan plan = sealed_plan(false);
    plan.gains = gains;
    seal(plan);
    EXPECT_FALSE(open_plan(canonical_bytes(plan), plan.seal));
  }
}

TEST(OpenPlan, RefusesEveryFlippedBitAndEveryTruncation) {
  const Plan plan = sealed_plan(true);
  std::vector<std::uint8_t> bytes = canonical_bytes(plan);
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    for (int bit = 0; bit < 8; ++bit) {
      bytes[n] ^= static_cast<std::uint8_t>(1 << bit);
      EXPECT_FALSE(open_plan(bytes, plan.seal)) << "byte " << n << " bit " << bit;
      bytes[n] ^= static_cast<std::uint8_t>(1 << bit);
    }
    EXPECT_FALSE(open_plan(std::span(bytes).first(n), plan.seal));
  }
}

TEST(OpenPlan, RefusesNumbersThatAreNone) {
  Plan plan = sealed_plan(false);
  plan.steps[0].depth = Millimetres(std::nan(""));
  seal(plan);
  EXPECT_FALSE(open_plan(canonical_bytes(plan), plan.seal));
}

TEST(OpenPlan, SurvivesAnyBytes) {
  std::mt19937 random(1);
  const Plan plan = sealed_plan(true);
  for (int round = 0; round < 20'000; ++round) {
    std::vector<std::uint8_t> bytes = canonical_bytes(plan);
    if (round % 2 == 0) bytes.resize(random() % 300);
    for (int change = 0; change < 4 && !bytes.empty(); ++change)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    if (bytes == canonical_bytes(plan)) continue;
    EXPECT_FALSE(open_plan(bytes, plan.seal));
  }
}

}  // namespace
}  // namespace biopsy::planner
