// The whole workflow on what no effect explains: the verdict stays "unexplained", and an equation is proposed
// beside it; where an effect is named, or nothing is missing, there is none.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/gap/find_gap.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/plant/model_text.hpp"
#include "tests/sim/gap/term/law_rig.hpp"

namespace biopsy::hidden {
namespace {

constexpr double kWholeNoise = 4e-6;  // m

struct Searched {
  LawRig rig;
  sim::PlantModel model;
  sim::gap::FoundGap found;
};

Searched searched(std::size_t law, std::uint64_t seed, double share) {
  Dice dice(seed);
  Searched out;
  out.rig = drawn_rig(dice);
  out.rig.law = outside_laws(out.rig, share, dice)[law];
  out.model = sim::parse_model(law_rig_model(out.rig, dice), "rig.toml");
  out.found = sim::gap::find_gap(law_recording(out.rig, kWholeNoise, seed), out.model, {});
  return out;
}

TEST(GapWithTerm, ProposesAnEquationBesideUnexplained) {
  const Searched one = searched(3, 81, 0.25);  // speed times position
  const GapFinding& finding = one.found.finding;
  ASSERT_EQ(finding.verdict, GapVerdict::Unexplained);
  EXPECT_TRUE(finding.effects.empty());
  EXPECT_EQ(finding.gap_closed, 0.0);  // of the model as it is
  ASSERT_TRUE(finding.proposed);
  EXPECT_EQ(finding.proposed->name, "proposed");
  EXPECT_EQ(finding.proposed->expression, "a x v");
  EXPECT_EQ(finding.proposed->coefficients.front().unit, "N s/m^2");
  EXPECT_GT(finding.proposed->gap_closed, 0.95);
  EXPECT_NE(finding.proposed->meaning.find("damping that depends on the place"), std::string::npos);
  EXPECT_TRUE(one.found.model.terms.empty());
}

TEST(GapWithTerm, TheProposedModelReadsBackAndExplainsTheSameRecording) {
  Searched one = searched(3, 81, 0.25);
  ASSERT_TRUE(one.found.proposed_model);
  const std::string text = sim::model_toml(*one.found.proposed_model, {});
  EXPECT_NE(text.find("[term.proposed]"), std::string::npos) << text;
  const GapFinding again =
      sim::gap::find_gap(law_recording(one.rig, kWholeNoise, 81), sim::parse_model(text, "m.toml"), {})
          .finding;
  EXPECT_TRUE(again.verdict == GapVerdict::NoGap || again.verdict == GapVerdict::Parameter);
  EXPECT_LT(again.rmse_before, 1.2 * again.noise_floor);
  EXPECT_FALSE(again.proposed);
}

TEST(GapWithTerm, IsTheSameEachTime) {
  const Searched one = searched(1, 81, 0.2), again = searched(1, 81, 0.2);
  ASSERT_TRUE(one.found.proposed_model);
  ASSERT_TRUE(again.found.proposed_model);
  EXPECT_EQ(sim::model_toml(*one.found.proposed_model, {}), sim::model_toml(*again.found.proposed_model, {}));
}

TEST(GapWithTerm, ProposesNothingWhereAnEffectIsNamed) {
  Dice dice(83);
  LawRig rig = drawn_rig(dice);
  rig.law.force = [](const LawPoint& p) { return -3.0 * p.v * std::abs(p.v); };
  const std::string model = law_rig_model(rig, dice);
  const GapFinding finding =
      sim::gap::find_gap(law_recording(rig, kWholeNoise, 83), sim::parse_model(model, "rig.toml"), {})
          .finding;
  ASSERT_EQ(finding.verdict, GapVerdict::Effect);
  EXPECT_EQ(finding.effects.front().name, "quadratic_damping");
  EXPECT_FALSE(finding.proposed);
}

// Drag that grows with the cube of the speed: that with its square closes 95 % of the gap and meets
// everything else that a name needs.
TEST(GapWithTerm, ANameGivesWayToAnEquationThatLeavesFarLess) {
  Dice dice(700);
  LawRig rig = drawn_rig(dice);
  rig.law = outside_laws(rig, dice.between(0.1, 0.4), dice)[0];
  const std::string model = law_rig_model(rig, dice);
  const GapFinding finding =
      sim::gap::find_gap(law_recording(rig, kWholeNoise, 701), sim::parse_model(model, "rig.toml"), {})
          .finding;
  EXPECT_EQ(finding.verdict, GapVerdict::Unexplained);
  EXPECT_EQ(finding.rejected.effects, std::vector<std::string>{"quadratic_damping"});
  ASSERT_EQ(finding.rejected.objections.size(), 1U);
  EXPECT_NE(finding.rejected.objections.front().find("an equation leaves far less"), std::string::npos)
      << finding.rejected.objections.front();
  ASSERT_TRUE(finding.proposed);
  EXPECT_EQ(finding.proposed->expression, "a v^3");
}

// Drag that grows with the root of the speed resembles friction that grows from breakaway to sliding:
// Stribeck friction the other way round.
TEST(GapWithTerm, ADragOfTheRootOfTheSpeedIsNoFriction) {
  for (const std::uint64_t seed : {85, 86, 87}) {
    Dice dice(seed);
    LawRig rig = drawn_rig(dice);
    rig.law.force = [](const LawPoint& p) {
      return -0.4 * p.v / std::sqrt(0.05 * std::max(std::abs(p.v), 1e-3));
    };
    const std::string model = law_rig_model(rig, dice);
    const GapFinding finding =
        sim::gap::find_gap(law_recording(rig, kWholeNoise, seed), sim::parse_model(model, "rig.toml"), {})
            .finding;
    EXPECT_EQ(finding.verdict, GapVerdict::Unexplained) << seed;
    EXPECT_TRUE(finding.effects.empty()) << seed << " " << finding.effects.front().name;
  }
}

// Damping and a wrong scale together come near to it.
TEST(GapWithTerm, AMotorThatWeakensWithItsSpeedHasNoName) {
  int found = 0;
  for (std::uint64_t seed = 88; seed < 91; ++seed) {
    Dice dice(seed);
    LawRig rig = drawn_rig(dice);
    const double fast = dice.between(0.15, 0.4);  // m/s, at which nothing is left of it
    rig.law.force = [fast](const LawPoint& p) { return -p.drive * std::min(1.0, std::abs(p.v) / fast); };
    const std::string model = law_rig_model(rig, dice);
    const GapFinding finding =
        sim::gap::find_gap(law_recording(rig, kWholeNoise, seed), sim::parse_model(model, "rig.toml"), {})
            .finding;
    EXPECT_TRUE(finding.effects.empty()) << seed << " " << finding.effects.front().name;
    found += finding.proposed && finding.proposed->expression.find("|v| u") != std::string::npos ? 1 : 0;
  }
  EXPECT_GE(found, 2) << "of 3, as an equation";
}

TEST(GapWithTerm, ProposesNothingWhereNothingIsMissingOrNoForceIs) {
  for (const auto& [shocks, wander] : std::vector<std::pair<double, double>>{{0, 0}, {1.0, 0}, {0, 5e-4}}) {
    Dice dice(84);
    LawRig rig = drawn_rig(dice);
    rig.shocks = shocks, rig.wander = wander;
    const std::string model = law_rig_model(rig, dice);
    const GapFinding finding =
        sim::gap::find_gap(law_recording(rig, kWholeNoise, 84), sim::parse_model(model, "rig.toml"), {})
            .finding;
    EXPECT_FALSE(finding.proposed) << shocks << " " << wander << " " << finding.proposed->expression;
    EXPECT_TRUE(finding.effects.empty()) << shocks << " " << wander;
  }
}

}  // namespace
}  // namespace biopsy::hidden
