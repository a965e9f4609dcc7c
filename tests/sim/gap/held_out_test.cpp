// What is held out, and when held-out readings tell two explanations apart: rigs of recordings/, which share
// no code with sim/, and residuals made here.
#include "sim/gap/select/held_out.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/gap/examine/examine.hpp"
#include "sim/gap/find_gap.hpp"
#include "sim/gap/select/exchange.hpp"
#include "sim/gap/select/told_apart.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/sim/gap/generator/hidden_physics.hpp"
#include "tests/sim/gap/recordings/rig.hpp"

namespace biopsy::hidden {
namespace {

using sim::gap::HeldOut;

constexpr double kReading = 5e-6;  // m
const Rig kGripped{.grip = 0.12};

// Four runs of a free rig, of which some are gripped.
sim::Dataset gripped_in(const std::vector<std::size_t>& gripped, std::uint64_t seed) {
  sim::Dataset out = rig_recording({}, kReading, seed);
  const sim::Dataset other = rig_recording(kGripped, kReading, seed);
  for (const std::size_t i : gripped) out.runs[i] = other.runs[i];
  return out;
}

HeldOut held_out_of(const sim::Dataset& data) {
  const sim::PlantModel model = sim::parse_model(rig_model({}), "rig.toml");
  return choose_held_out(sim::gap::baseline_hypothesis(model, {}),
                         sim::gap::prepare(data, model, {}, sim::gap::Sampling::Coarse));
}

TEST(HeldOut, IsEveryThirdRunWhereAllShowTheGapOrNone) {
  EXPECT_EQ(held_out_of(gripped_in({0, 1, 2, 3}, 31)), HeldOut::FromSecond);
  EXPECT_EQ(held_out_of(gripped_in({}, 32)), HeldOut::FromSecond);
}

TEST(HeldOut, IsAnotherRunWhereTheUsualOneShowsNothing) {
  const HeldOut chosen = held_out_of(gripped_in({0, 2}, 33));
  EXPECT_TRUE(chosen == HeldOut::FromFirst || chosen == HeldOut::FromThird);
}

TEST(HeldOut, IsTheEndOfEachRunWhereOneAloneShowsTheGap) {
  const sim::Dataset data = gripped_in({1}, 34);
  EXPECT_EQ(held_out_of(data), HeldOut::LastThirds);
  auto evidence =
      sim::gap::prepare(data, sim::parse_model(rig_model({}), "rig.toml"), {}, sim::gap::Sampling::Coarse);
  EXPECT_TRUE(can_exchange(evidence));
  hold_out(evidence, HeldOut::LastThirds);
  EXPECT_FALSE(can_exchange(evidence));
  EXPECT_NEAR(evidence.held_out_seconds, evidence.training_seconds / 2.0, 0.1);
}

TEST(HeldOut, StaysWhatTheDataSetSays) {
  sim::Dataset data = gripped_in({1}, 35);
  for (std::size_t i = 0; i < data.runs.size(); ++i)
    data.runs[i].role = i == 3 ? sim::RunRole::Test : sim::RunRole::Train;
  auto evidence =
      sim::gap::prepare(data, sim::parse_model(rig_model({}), "rig.toml"), {}, sim::gap::Sampling::Coarse);
  hold_out(evidence, HeldOut::LastThirds);
  EXPECT_EQ(evidence.runs[3].training_rows, 0U);
  EXPECT_EQ(evidence.runs[1].training_rows, evidence.runs[1].rows.size());
}

// One explanation leaves white noise, the other a wave of some amplitude beside it.
double told_apart(double noises_left, double wave_noises) {
  Dice dice(77);
  sim::gap::Evidence evidence;
  evidence.noise = kReading;
  sim::gap::ScoredModel a, b;
  for (int i = 0; i < 4000; ++i) {
    const double white = kReading * std::hypot(1.0, noises_left) * dice.normal();
    a.residual.push_back(white);
    b.residual.push_back(white + wave_noises * kReading * std::sin(0.01 * i));
    a.square += a.residual.back() * a.residual.back() / 4000.0;
    b.square += b.residual.back() * b.residual.back() / 4000.0;
  }
  return paired_evidence(a, b, evidence);
}

TEST(ToldApart, ByEveryReadingWhereOnlyNoiseIsLeft) {
  EXPECT_GT(told_apart(0.0, 0.4), 10.0);
  EXPECT_EQ(told_apart(0.0, 0.05), 0.0);  // integrators differ by as much
  EXPECT_EQ(told_apart(1.0, 0.4), 0.0);   // neither is right
}

// Blows ring down in a few periods of six readings each: a reading is not wrong because it is a peak.
TEST(Outliers, ArePeaksOfNoFastMotion) {
  const Rig fast{.hertz = 41.0, .damping_ratio = 0.08};
  const sim::Dataset data = rig_recording(fast, kReading, 41);
  for (const DataRemark& remark :
       sim::gap::examine(data, sim::parse_model(rig_model(fast), "rig.toml"), kReading))
    EXPECT_NE(remark.cause, "outliers") << remark.sentence;
}

bool has_outliers(const sim::Dataset& data, const Rig& rig) {
  const auto remarks = sim::gap::examine(data, sim::parse_model(rig_model(rig), "rig.toml"), kReading);
  return std::ranges::any_of(remarks, [](const DataRemark& remark) { return remark.cause == "outliers"; });
}

// By the law of impact: five rows to the stop, twenty back at a fifth of the speed.
TEST(Outliers, AreNoReadingBeforeABounce) {
  sim::Dataset data = rig_recording({}, kReading, 42);
  constexpr std::size_t kBegin = 200, kHit = kBegin + 4, kEnd = kHit + 20;
  for (sim::RecordedRun& run : data.runs)
    for (std::size_t i = 0; i < run.displacement.size(); ++i) {
      double& x = run.displacement[i] = 0.0;
      if (i >= kBegin && i <= kHit) x = 0.5e-3 * static_cast<double>(i - kBegin);
      if (i > kHit && i < kEnd) x = 0.1e-3 * static_cast<double>(kEnd - i);
    }
  EXPECT_FALSE(has_outliers(data, {}));
  data.runs[0].displacement[kHit + 8] += 0.5e-3;
  EXPECT_TRUE(has_outliers(data, {}));
}

}  // namespace
}  // namespace biopsy::hidden
