// The first strength is extrapolated linearly. With a nonlinear response it overshoots a ridge of the cost,
// and the search must restart from a weaker one.
#include <gtest/gtest.h>

#include <algorithm>

#include "sim/gap/find_gap.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/sim/gap/generator/hidden_cases.hpp"
#include "tests/sim/gap/generator/hidden_data.hpp"

namespace biopsy::hidden {
namespace {

TEST(Overshoot, AHardeningThatShiftsTheResonanceIsFound) {
  const auto all = hidden_cases();
  HiddenCase hidden =
      *std::ranges::find(all, std::string("spring_hardening/force-strong"), &HiddenCase::name);
  hidden.length = 0.35;
  hidden.runs = 3;
  const sim::PlantModel model = sim::parse_model(baseline_model(hidden), "model.toml");
  const GapFinding finding = sim::gap::find_gap(make_hidden(hidden), model, {}).finding;
  ASSERT_EQ(finding.verdict, GapVerdict::Effect);
  EXPECT_EQ(finding.effects[0].name, "spring_hardening");
  EXPECT_NEAR(finding.effects[0].parameters[0].value, 1e-9 * hidden.terms[0].strength, 0.5e-3);  // N/mm3
}

}  // namespace
}  // namespace biopsy::hidden
