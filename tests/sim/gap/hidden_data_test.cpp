// Hidden data sets: repeatable, visible, and without the answer in their files.
#include "tests/sim/gap/generator/hidden_data.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "tests/scratch_folder.hpp"

namespace biopsy::hidden {
namespace {

HiddenCase named(const std::string& name) {
  for (const HiddenCase& hidden : hidden_cases())
    if (hidden.name == name) return hidden;
  throw std::invalid_argument("no case " + name);
}

HiddenCase brief(HiddenCase hidden) {
  hidden.length = 0.25;
  return hidden;
}

TEST(HiddenCases, CoverEveryEffectTwiceAndAllKinds) {
  const std::set<std::string> library{"charge_retention",
                                      "amplifier_lag",
                                      "voltage_saturation",
                                      "polarity_asymmetry",
                                      "voltage_threshold",
                                      "zipping_hysteresis",
                                      "residual_set",
                                      "pouch_creep",
                                      "coulomb_friction",
                                      "stribeck_friction",
                                      "quadratic_damping",
                                      "spring_hardening",
                                      "hysteretic_spring",
                                      "backlash",
                                      "end_stop",
                                      "added_mass",
                                      "external_force",
                                      "periodic_disturbance",
                                      "layer_puncture",
                                      "shaft_friction",
                                      "tissue_relaxation",
                                      "sensor_lag",
                                      "sensor_offset",
                                      "sensor_scale",
                                      "sensor_drift",
                                      "zipping_capacitance",
                                      "load_dependent_friction",
                                      "lugre_friction",
                                      "asymmetric_spring",
                                      "piecewise_spring",
                                      "directional_damping",
                                      "slow_unzipping",
                                      "voltage_power",
                                      "hardening_hysteresis"};
  std::map<std::string, std::set<double>> strengths;
  std::map<HiddenKind, int> kinds;
  std::set<std::string> names, outside, hundred;
  for (const HiddenCase& hidden : hidden_cases()) {
    ++kinds[hidden.kind];
    EXPECT_TRUE(names.insert(hidden.name).second) << hidden.name << " twice";
    for (const HiddenTerm& term : hidden.terms) {
      if (hidden.group == "singles") strengths[term.name].insert(term.strength);
      if (hidden.kind == HiddenKind::Outside) outside.insert(term.name);
    }
    if (hidden.period == 10e-3) hundred.insert(hidden.name);
  }
  EXPECT_EQ(strengths.size(), library.size());
  for (const std::string& name : library) EXPECT_EQ(strengths[name].size(), 2U) << name;
  for (const std::string& name : outside) EXPECT_FALSE(library.contains(name)) << name;
  EXPECT_GE(kinds[HiddenKind::Pair], 6);
  EXPECT_GE(kinds[HiddenKind::Nothing], 20);
  EXPECT_GE(kinds[HiddenKind::Parameter], 5);
  EXPECT_GE(outside.size(), 6U);
  EXPECT_GE(hundred.size(), 5U);
}

TEST(HiddenCases, QuickOnesHoldEveryKindAndAreShort) {
  std::set<HiddenKind> kinds;
  for (const HiddenCase& hidden : quick_cases()) {
    kinds.insert(hidden.kind);
    EXPECT_LE(hidden.runs, 4);
    EXPECT_LE(hidden.length, 0.5);
  }
  EXPECT_EQ(kinds.size(), 5U);
  EXPECT_EQ(quick_cases().size(), 20U);
}

TEST(HiddenData, IsTheSameForTheSameSeedOnly) {
  const HiddenCase hidden = brief(named("random_shocks/strong"));
  const auto once = make_hidden(hidden), again = make_hidden(hidden),
             other = make_hidden(reseeded(hidden, 2));
  EXPECT_EQ(once.runs[0].displacement, again.runs[0].displacement);
  EXPECT_EQ(once.runs[2].input, again.runs[2].input);
  EXPECT_NE(once.runs[0].displacement, other.runs[0].displacement);
  EXPECT_NE(once.runs[2].input, other.runs[2].input);
}

TEST(HiddenData, OfNothingIsTheNominalBaselineAndNoise) {
  for (const char* name : {"nothing/exact-0", "nothing/exact-4"}) {  // 10 um and 50 um
    const HiddenCase hidden = brief(named(name));
    double sum = 0.0, count = 0.0;
    for (const sim::RecordedRun& run : make_hidden(hidden).runs) {
      const Trace truth = run_stage({}, {}, {run.period, run.weight, run.input, run.external_force}, 1);
      for (std::size_t row = 0; row < run.time.size(); ++row, ++count)
        sum += std::pow(1e6 * (run.displacement[row] - truth.displacement[row]), 2);
    }
    EXPECT_NEAR(std::sqrt(sum / count) / hidden.noise_um, 1.0, 0.02) << name;
  }
}

TEST(HiddenData, LeavesOutWhatTheCaseLeavesOut) {
  const auto bare = make_hidden(brief(named("coulomb_friction/bare")));
  EXPECT_FALSE(bare.sensor_noise);
  EXPECT_TRUE(bare.runs[0].plate_b.empty() && bare.runs[0].current.empty());
  EXPECT_EQ(make_hidden(brief(named("coulomb_friction/two"))).runs.size(), 2U);
  EXPECT_EQ(make_hidden(brief(named("backlash/eight"))).runs.size(), 8U);
  EXPECT_DOUBLE_EQ(make_hidden(brief(named("pouch_creep/100Hz"))).runs[0].time[1], 0.01);
}

TEST(HiddenData, FolderReadsBackWithoutTheAnswer) {
  for (const char* name : {"coulomb_friction/strong", "coulomb_friction/force-strong"}) {
    const HiddenCase hidden = brief(named(name));
    ScratchFolder folder;
    write_hidden(hidden, folder.path());
    const auto drive = hidden.force_drive ? sim::Drive::Force : sim::Drive::Stack;
    const auto made = make_hidden(hidden), read = sim::read_dataset(folder.path(), drive);
    ASSERT_EQ(read.runs.size(), made.runs.size());
    for (std::size_t run = 0; run < made.runs.size(); ++run) {
      ASSERT_EQ(read.runs[run].time.size(), made.runs[run].time.size());
      for (std::size_t row = 0; row < made.runs[run].time.size(); row += 97) {
        EXPECT_NEAR(read.runs[run].displacement[row], made.runs[run].displacement[row], 1e-7);
        EXPECT_NEAR(read.runs[run].input[row], made.runs[run].input[row], 1e-4);
      }
    }
    for (const auto& file : std::filesystem::directory_iterator(folder.path()))
      EXPECT_EQ(file_content(file.path()).find("coulomb"), std::string::npos) << file.path();
  }
}

struct EveryCaseInTheLibrary : testing::TestWithParam<std::string> {};

TEST_P(EveryCaseInTheLibrary, StandsThreeTimesAboveTheNoise) {  // the stronger ones do if the weaker does
  HiddenCase hidden = named(GetParam() + "/visible");
  hidden.length = 0.5;
  EXPECT_GE(effect_rms(hidden), 3e-3 * hidden.noise_um);
}

INSTANTIATE_TEST_SUITE_P(Of, EveryCaseInTheLibrary, testing::ValuesIn(hidden_effect_names()),
                         [](const auto& each) { return each.param; });

}  // namespace
}  // namespace biopsy::hidden
