// Which name is given, and when none is: rigs of recordings/, which share no code with sim/. Nothing is told
// about what is free.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "sim/gap/find_gap.hpp"
#include "sim/gap/select/choose.hpp"
#include "sim/gap/select/evidence_runs.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/sim/gap/recordings/rig.hpp"

namespace biopsy::hidden {
namespace {

constexpr double kRigNoise = 5e-6;  // m

sim::PlantModel model_of(const Rig& rig) {
  return sim::parse_model(rig_model(rig), "rig.toml");
}

GapFinding found(const Rig& truth, const Rig& believed, std::uint64_t seed) {
  return sim::gap::find_gap(rig_recording(truth, kRigNoise, seed), model_of(believed), {}).finding;
}

// For a failure: what was not given as a name, and why.
std::string why(const GapFinding& f) {
  std::string out;
  for (const std::string& name : f.rejected.effects) out += name + " ";
  for (const std::string& one : f.rejected.objections) out += "; " + one;
  for (const GapCandidate& one : f.candidates) out += fmt::format("\n{} {}", one.name, one.probability);
  return out;
}

TEST(Naming, DryFrictionIsNamedThoughMassAndDampingAreNotWhatTheModelSays) {
  const GapFinding f = found({.grip = 0.12}, {.mass = 0.55, .hertz = 2.9, .damping_ratio = 0.4}, 3);
  ASSERT_EQ(f.verdict, GapVerdict::Effect) << why(f);
  EXPECT_EQ(f.effects.front().name, "coulomb_friction");
  EXPECT_NEAR(f.effects.front().parameters.front().value, 0.12, 0.012);
  EXPECT_TRUE(f.comparison.chosen);
  EXPECT_FALSE(f.comparison.free.empty());
}

TEST(Naming, DryFrictionThatDiffersByDirectionIsSaidForEither) {
  const GapFinding f = found({.grip = 0.15, .one_way = 0.06}, {}, 13);
  ASSERT_EQ(f.verdict, GapVerdict::Effect) << why(f);
  ASSERT_EQ(f.effects.size(), 2U);
  double friction = 0.0, force = 0.0;
  for (const FoundEffect& effect : f.effects) {
    const double value = effect.parameters.front().value;
    if (effect.name == "coulomb_friction") friction = value;
    if (effect.name != "external_force") continue;
    force = value;
    EXPECT_NE(effect.sentence.find("0.21 N while plate A rises and 0.0"), std::string::npos)
        << effect.sentence;
  }
  EXPECT_NEAR(friction + force, 0.21, 0.004);
  EXPECT_NEAR(friction - force, 0.09, 0.004);
}

TEST(Naming, FrictionThatGrowsWithThePushIsNoCoulombFriction) {
  for (const double share : {0.04, 0.15}) {
    const GapFinding f = found({.side_load = share}, {.damping_ratio = 0.17}, 31);
    ASSERT_EQ(f.verdict, GapVerdict::Effect) << share;
    EXPECT_EQ(f.effects.front().name, "load_dependent_friction");
    EXPECT_NEAR(f.effects.front().parameters.front().value, share, 0.1 * share);
  }
}

TEST(Naming, AStiffeningSpringIsNoTissueAndNoEndStop) {
  const GapFinding f = found({.stiffening = 4e3}, {}, 5);
  ASSERT_EQ(f.verdict, GapVerdict::Effect) << why(f);
  EXPECT_EQ(f.effects.front().name, "spring_hardening");
  EXPECT_FALSE(f.partial);
  EXPECT_FALSE(f.comparison.tissue);
}

// Half as stiff again at the largest motion, up to several times: the ringing is far out of step.
TEST(Naming, AStiffeningSpringIsNamedHoweverFarItShiftsTheResonance) {
  for (const double stiffening : {50.0, 400.0, 3e3}) {
    const GapFinding f =
        found({.damping_ratio = 0.05, .stiffening = stiffening}, {.damping_ratio = 0.05}, 23);
    ASSERT_EQ(f.verdict, GapVerdict::Effect) << stiffening << " " << why(f);
    EXPECT_EQ(f.effects.front().name, "spring_hardening") << stiffening;
    EXPECT_FALSE(f.partial) << stiffening;
  }
}

// Bristles of the given model that nobody sees concern no other candidate.
TEST(Naming, AStiffeningSpringIsNamedBesideAKnownFriction) {
  const sim::PlantModel given =
      sim::parse_model(rig_model({}) +
                           "[effect.lugre_friction]\nsliding_N = 0.12\nbreakaway_N = 0.12\nspeed_mm_s = 1.0\n"
                           "stiffness_N_per_mm = 200.0\n",
                       "rig.toml");
  const GapFinding f =
      sim::gap::find_gap(rig_recording({.grip = 0.12, .stiffening = 4e3}, kRigNoise, 37), given, {}).finding;
  ASSERT_EQ(f.verdict, GapVerdict::Effect) << why(f);
  EXPECT_EQ(f.effects.front().name, "spring_hardening");
  EXPECT_EQ(f.effects.size(), 1U);
  EXPECT_FALSE(f.partial);
}

TEST(Naming, DampingAroundAPlaceHasNoName) {
  const GapFinding f = found({.rough = 6.0, .rough_at = 4e-3}, {}, 7);
  EXPECT_EQ(f.verdict, GapVerdict::Unexplained);
  EXPECT_TRUE(f.effects.empty());
}

TEST(Naming, AForceAroundAPlaceHasNoName) {
  const GapFinding f = found({.dent = 0.2, .dent_at = 4e-3}, {}, 9);
  EXPECT_EQ(f.verdict, GapVerdict::Unexplained);
  EXPECT_TRUE(f.effects.empty());
  EXPECT_TRUE(f.data.empty()) << f.data.front().sentence;
}

// The only effect that is found, its first parameters beside the truth.
void expect_alone(const Rig& truth, std::uint64_t seed, const std::string& name,
                  const std::vector<double>& values) {
  const GapFinding f = found(truth, {}, seed);
  ASSERT_EQ(f.verdict, GapVerdict::Effect) << name << ", " << why(f);
  EXPECT_EQ(f.effects.size(), 1U);
  EXPECT_EQ(f.effects.front().name, name);
  EXPECT_FALSE(f.partial);
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_NEAR(f.effects.front().parameters[i].value, values[i], 0.1 * std::abs(values.back())) << name;
}

constexpr double kRigStiffness = 0.4 * 15.70796 * 15.70796;  // N/m
constexpr double kRigDamping = 2.0 * 0.15 * 15.70796 * 0.4;  // N s/m

TEST(Naming, ASpringThatIsStifferInOneDirectionIsAsymmetric) {
  for (const double lopsided : {8.0, -4.0})
    expect_alone({.lopsided = lopsided}, 9, "asymmetric_spring", {-1e-6 * kRigStiffness * lopsided});
}

TEST(Naming, ASecondSpringIsNeitherAnEndStopNorHardening) {
  for (const double second : {0.7, -0.4})
    expect_alone({.second = second, .second_at = 4e-3}, 15, "piecewise_spring",
                 {1e-3 * kRigStiffness * second, 4.0});
}

TEST(Naming, DampingThatDiffersByDirectionIsSaidSo) {
  for (const double valve : {0.5, 3.0})
    expect_alone({.valve = valve}, 21, "directional_damping", {-kRigDamping * valve});
}

// Its mean over a run is another stiffness, which closes most of the gap.
TEST(Naming, ASpringThatSoftensWithTimeIsNoSpringOfAnotherStiffness) {
  for (const double share : {0.02, 0.06, 0.2}) {
    const GapFinding f = found({.softens = share}, {}, 19);
    EXPECT_EQ(f.verdict, GapVerdict::Unexplained) << share;
    EXPECT_TRUE(f.effects.empty() && f.parameters_changed.empty()) << share;
  }
}

// The plate slips in the clamp that the laser looks at.
TEST(Naming, AReadingThatJumpsIsNoDrift) {
  for (const std::size_t row : {500U, 900U}) {
    sim::Dataset data = rig_recording({}, kRigNoise, 27);
    for (sim::RecordedRun& run : data.runs)
      for (std::size_t i = row; i < run.displacement.size(); ++i) run.displacement[i] += 0.3e-3;
    const GapFinding f = sim::gap::find_gap(data, model_of({}), {}).finding;
    EXPECT_EQ(f.verdict, GapVerdict::Unexplained) << row;
    EXPECT_TRUE(f.effects.empty()) << row;
  }
}

// Sampled six times in an oscillation: differences see the motion, a linear equation of motion does not.
TEST(Noise, IsNotTakenFromFastMotion) {
  for (const Rig& rig : {Rig{.hertz = 42.0, .damping_ratio = 0.01}, Rig{.hertz = 2.5}}) {
    sim::Dataset data = rig_recording(rig, kRigNoise, 17);
    std::uint32_t bits = 1;
    for (sim::RecordedRun& run : data.runs)  // a force of all frequencies
      for (double& x : run.input)
        x = 5.0 * (static_cast<double>(bits = bits * 1664525U + 1013904223U) * 0x1p-32 - 0.5);
    data = ridden_again(rig, data, kRigNoise);
    EXPECT_NEAR(sim::gap::estimated_noise(data.runs), kRigNoise, 0.35 * kRigNoise) << rig.hertz;
  }
}

TEST(Choice, OfAMechanismThatIsAsTheModelSaysIsNothing) {
  const sim::gap::Choice choice = sim::gap::choose(rig_recording({}, kRigNoise, 11), model_of({}));
  EXPECT_TRUE(choice.free.empty());
  EXPECT_FALSE(choice.window);
  EXPECT_EQ(choice.reason, "");
}

TEST(Choice, FreesWhatTheDataDetermineAndCutsWhatDrifts) {
  const auto data = rig_recording({}, kRigNoise, 13);
  const sim::gap::Choice wrong = sim::gap::choose(data, model_of({.mass = 0.6, .hertz = 2.0}));
  EXPECT_EQ(wrong.free, (std::vector<std::string>{"m", "c_s", "k"}));
  sim::PlantModel loose = model_of({});
  loose.baseline.k = 0.0;
  EXPECT_TRUE(sim::gap::choose(data, loose).window);
}

}  // namespace
}  // namespace biopsy::hidden
