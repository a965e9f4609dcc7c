// Effects that resemble each other: what is named need not be right, but must not be the other one. The stage
// of generator/, which shares no code with sim/, with strengths and errors of its parameters drawn here.
#include <gtest/gtest.h>

#include <algorithm>

#include "sim/gap/find_gap.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/sim/gap/generator/hidden_data.hpp"
#include "tests/sim/gap/recordings/rig.hpp"

namespace biopsy::hidden {
namespace {

constexpr double kHalfClosed = 0.5;
constexpr double kDrawnRigNoise = 4e-6;  // m

HiddenCase drawn(const std::string& effect, double strength, std::uint64_t seed) {
  HiddenCase out;
  out.name = effect;
  out.kind = HiddenKind::Single;
  out.terms = {{effect, strength}};
  out.seed = seed;
  out.length = 0.35;
  out.runs = 3;
  return out;
}

GapFinding answer(const HiddenCase& hidden) {
  return sim::gap::find_gap(make_hidden(hidden), sim::parse_model(baseline_model(hidden), "model.toml"), {})
      .finding;
}

bool names(const GapFinding& finding, const std::string& effect) {
  return std::ranges::any_of(finding.effects, [&](const FoundEffect& one) { return one.name == effect; });
}

// A name goes with a gap that it closes.
void expect_no_empty_name(const GapFinding& finding) {
  if (finding.verdict == GapVerdict::Effect) {
    EXPECT_GT(finding.gap_closed, kHalfClosed);
  }
  EXPECT_EQ(finding.effects.empty(), finding.verdict != GapVerdict::Effect);
}

TEST(WrongNames, AResidualSetIsNotCalledCreep) {
  Dice dice(20260117);
  for (std::uint64_t seed = 9001; seed < 9004; ++seed) {
    const GapFinding finding = answer(drawn("residual_set", dice.between(0.04, 0.20), seed));
    EXPECT_FALSE(names(finding, "pouch_creep")) << seed;
    expect_no_empty_name(finding);
  }
}

TEST(WrongNames, AStiffeningSpringOfTheStageIsNoPuncture) {
  Dice dice(20260118);
  for (std::uint64_t seed = 9101; seed < 9103; ++seed) {
    const GapFinding finding = answer(drawn("spring_hardening", dice.between(5e6, 3e7), seed));
    EXPECT_FALSE(names(finding, "layer_puncture")) << seed;
    expect_no_empty_name(finding);
  }
}

TEST(WrongNames, AStiffeningSpringOfAMechanismIsNoPuncture) {
  Dice dice(20260119);
  for (std::uint64_t seed = 9201; seed < 9204; ++seed) {
    const Rig truth{.mass = dice.between(0.2, 0.8),
                    .hertz = dice.between(1.5, 4.0),
                    .damping_ratio = dice.between(0.05, 0.3),
                    .stiffening = dice.between(1e3, 2e4)};
    Rig believed = truth;
    believed.stiffening = 0.0;
    sim::Dataset data = rig_recording(truth, kDrawnRigNoise, seed);
    data.tissue = true;  // even where tissue may be there
    const GapFinding finding =
        sim::gap::find_gap(data, sim::parse_model(rig_model(believed), "rig.toml"), {}).finding;
    EXPECT_FALSE(names(finding, "layer_puncture")) << seed;
    EXPECT_TRUE(names(finding, "spring_hardening") || finding.verdict == GapVerdict::Unexplained) << seed;
    expect_no_empty_name(finding);
  }
}

// Of a short recording the one run that is held out may hold next to nothing of what the others show.
TEST(WrongNames, AStiffeningSpringThatTheHeldOutRunHardlyReachesIsNoWrongNumber) {
  Dice dice(20260120);
  int seen = 0;
  for (std::uint64_t seed = 9301; seed < 9307; ++seed) {
    const HiddenCase one = drawn("spring_hardening", dice.between(1.5e7, 4e7), seed);
    if (1e3 * identifiable_rms(one) < one.noise_um) continue;
    ++seen;
    const GapFinding finding = answer(one);
    EXPECT_NE(finding.verdict, GapVerdict::Parameter) << seed;
    EXPECT_TRUE(names(finding, "spring_hardening") || finding.verdict == GapVerdict::Unexplained) << seed;
  }
  EXPECT_GE(seen, 3);
}

// Grease, say: the library's shaft friction could be fitted without its friction.
TEST(WrongNames, DragThatGrowsWithDepthIsNoFrictionOfTheShaft) {
  Dice dice(20260121);
  for (std::uint64_t seed = 9401; seed < 9403; ++seed) {
    HiddenCase one = drawn("shaft_friction", 0.0, seed);
    one.terms.clear();
    HiddenPhysics greased;
    greased.shaft_viscous = dice.between(2e3, 8e3);
    const GapFinding finding =
        sim::gap::find_gap(make_hidden(one, greased), sim::parse_model(baseline_model(one), "model.toml"), {})
            .finding;
    EXPECT_FALSE(names(finding, "shaft_friction")) << seed;
  }
}

// u/(1 + |u|/L): no voltage is reached at which a higher command changes nothing.
TEST(WrongNames, AGainThatFallsWithTheVoltageIsNoSaturation) {
  Dice dice(20260122);
  for (std::uint64_t seed = 9501; seed < 9503; ++seed) {
    HiddenCase one = drawn("voltage_saturation", 0.0, seed);
    one.terms.clear();
    HiddenPhysics bent;
    bent.saturation = dice.between(2e4, 4e4);
    bent.saturation_power = 1.0;
    const GapFinding finding =
        sim::gap::find_gap(make_hidden(one, bent), sim::parse_model(baseline_model(one), "model.toml"), {})
            .finding;
    EXPECT_EQ(finding.verdict, GapVerdict::Unexplained) << seed;
    EXPECT_FALSE(names(finding, "voltage_saturation")) << seed;
  }
}

}  // namespace
}  // namespace biopsy::hidden
