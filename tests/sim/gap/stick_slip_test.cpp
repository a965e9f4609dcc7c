// Stick-slip: the instant of breakaway decides all that follows, so that only windows of the runs can be
// predicted.
#include <gtest/gtest.h>

#include <algorithm>

#include "sim/gap/find_gap.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/sim/gap/generator/hidden_cases.hpp"
#include "tests/sim/gap/generator/hidden_data.hpp"

namespace biopsy::hidden {
namespace {

constexpr double kSliding = 0.30;  // N; the hidden breakaway is twice that
constexpr double kWithin = 0.15;   // of a number, friction being regularised otherwise there

GapFinding finding_of(const char* effect, double strength) {
  const auto all = hidden_cases();
  HiddenCase hidden =
      *std::ranges::find(all, std::string("coulomb_friction/force-strong"), &HiddenCase::name);
  hidden.terms = {{effect, strength}};
  hidden.length = 0.5;
  hidden.runs = 3;
  hidden.seed = 5;
  const sim::PlantModel model = sim::parse_model(baseline_model(hidden), "model.toml");
  return sim::gap::find_gap(make_hidden(hidden), model, {}).finding;
}

bool mentions_windows(const GapFinding& finding) {
  return std::ranges::any_of(
      finding.warnings, [](const std::string& text) { return text.find("windows") != std::string::npos; });
}

TEST(StickSlip, IsFoundInWindowsThatStartFromTheMeasuredMotion) {
  const GapFinding finding = finding_of("stribeck_friction", kSliding);
  ASSERT_EQ(finding.verdict, GapVerdict::Effect);
  ASSERT_EQ(finding.effects.size(), 1U);
  EXPECT_EQ(finding.effects[0].name, "stribeck_friction");
  EXPECT_NEAR(finding.effects[0].parameters[0].value, kSliding, kWithin * kSliding);
  EXPECT_NEAR(finding.effects[0].parameters[1].value, 2.0 * kSliding, kWithin * 2.0 * kSliding);
  EXPECT_TRUE(mentions_windows(finding));
}

TEST(StickSlip, IsNotFoundWhereCoulombFrictionExplainsWholeRuns) {
  const GapFinding finding = finding_of("coulomb_friction", kSliding);
  ASSERT_EQ(finding.verdict, GapVerdict::Effect);
  EXPECT_EQ(finding.effects[0].name, "coulomb_friction");
  EXPECT_FALSE(mentions_windows(finding));
}

}  // namespace
}  // namespace biopsy::hidden
