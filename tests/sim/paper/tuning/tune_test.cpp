// A whole tuning, on a coarse grid.
#include "sim/paper/tuning/tune.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "robot/common/config_error.hpp"
#include "sim/paper/tuning/uncertainty.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim::tuning {
namespace {

NotedModel noted_model() {
  NotedModel model = read_noted_model(source_dir() / "sim/models/rehearsal.toml");
  model.model.baseline.tau_h = 0.3;
  model.model.baseline.c_s = 1.7;
  model.model.baseline.V0 = 1.2e-7;
  return model;
}

const TuneOptions kQuick{.stages = 2, .seed = 3, .wanted = {}, .grid = 5};

class Tuned : public testing::Test {
 protected:
  static void SetUpTestSuite() { found_ = tune(noted_model(), kQuick); }
  static const EvaluatedGains& paper() { return found_.evaluated.at(0); }
  static const EvaluatedGains& tuned() { return found_.evaluated.at(1); }
  static const EvaluatedGains& fed() { return found_.evaluated.at(3); }
  static inline Tuning found_;
};

TEST_F(Tuned, GainsKeepTheMarginsOnEveryStage) {
  ASSERT_TRUE(found_.met);
  EXPECT_TRUE(tuned().worst_margins.meet(found_.wanted));
  for (const Margins& here : tuned().at_depth) {
    EXPECT_TRUE(here.meet(found_.wanted));
    EXPECT_GE(here.gain_dB, tuned().worst_margins.gain_dB);
  }
}

TEST_F(Tuned, GainsAreNoWorseThanThePapersInTheWorstCase) {
  if (paper().worst_margins.meet(found_.wanted)) {
    EXPECT_LE(tuned().worst.cost(), paper().worst.cost());
  } else {  // the paper's gains were not to be had; then the tuned ones are safer
    EXPECT_GT(tuned().worst_margins.gain_dB, paper().worst_margins.gain_dB);
  }
}

TEST_F(Tuned, TheWorstStageIsNoBetterThanTheModel) {
  for (const EvaluatedGains& one : found_.evaluated) {
    EXPECT_GE(one.worst.settled_rmse, one.nominal.settled_rmse);
    EXPECT_GE(one.worst.overshoot, one.nominal.overshoot);
    EXPECT_GE(one.worst.cost(), one.nominal.cost());
  }
}

TEST_F(Tuned, FeedForwardIsNamedAndFollowsTheSineBetter) {
  EXPECT_FALSE(paper().feed);
  EXPECT_FALSE(tuned().feed);
  EXPECT_TRUE(fed().feed);
  EXPECT_LT(fed().nominal.sine_rmse, tuned().nominal.sine_rmse);
}

TEST_F(Tuned, TheSameSeedGivesTheSameGains) {
  const Tuning again = tune(noted_model(), kQuick);
  EXPECT_EQ(again.evaluated.at(1).gains.proportional_V_per_mm, tuned().gains.proportional_V_per_mm);
  EXPECT_EQ(again.evaluated.at(1).gains.integral_V_per_mm_per_tick, tuned().gains.integral_V_per_mm_per_tick);
  EXPECT_EQ(again.evaluated.at(1).worst.settled_rmse, tuned().worst.settled_rmse);
}

TEST(Tune, ReportsWhereNoGainsHaveTheMargins) {
  TuneOptions options = kQuick;
  options.wanted = {60.0, 120.0};
  EXPECT_FALSE(tune(noted_model(), options).met);
}

TEST(Tune, UsesDepthsWithinTheStroke) {
  NotedModel model = noted_model();
  model.model.baseline.V0 = 0.6e-7;  // about 7 mm with 8 kV
  TuneOptions options = kQuick;
  options.stages = 0;
  EXPECT_EQ(tune(model, options).depths, (std::vector<double>{1.0, 3.0, 5.0}));
}

TEST(Tune, RefusesAForceDrivenStage) {
  NotedModel model;
  model.model.baseline.drive = Drive::Force;
  EXPECT_THROW(tune(model, kQuick), ConfigError);
}

TEST(Uncertainty, FollowsTheFilesDeviations) {
  NotedModel model = noted_model();
  model.notes.values["k"] = {5.0, "test"};
  model.notes.values["stribeck_friction.speed_mm_s"] = {0.2, "test"};
  const UncertainStages drawn = uncertain_stages(model, 2000, 1);
  EXPECT_EQ(drawn.varied, (std::vector<std::string>{"k", "stribeck_friction.speed_mm_s"}));
  double sum = 0.0, squares = 0.0, speeds = 0.0;
  for (const PlantModel& stage : drawn.stages) {
    const double off = stage.baseline.k - model.model.baseline.k;
    sum += off, squares += off * off;
    speeds += std::pow(stage.effects.stribeck_friction->speed - 2e-3, 2);
    EXPECT_LE(std::abs(off), 10.0);
    EXPECT_EQ(stage.baseline.c_s, model.model.baseline.c_s);
  }
  EXPECT_NEAR(sum / 2000.0, 0.0, 0.4);
  // A normal cut at two deviations keeps what lies outside at the cut: std 0.96 of the whole.
  EXPECT_NEAR(std::sqrt(squares / 2000.0), 4.8, 0.25);
  EXPECT_NEAR(std::sqrt(speeds / 2000.0), 0.192e-3, 0.01e-3);
  EXPECT_FALSE(drawn.assumed);
}

TEST(Uncertainty, DrawsCorrelatedParameters) {
  NotedModel model = noted_model();
  model.notes.values["k"] = {5.0, "test"};
  model.notes.values["tau"] = {0.5, "test"};
  model.notes.values["c_s"] = {0.02, "test"};
  model.notes.correlations = Correlations{{"k", "tau"}, {-0.9}};
  const UncertainStages drawn = uncertain_stages(model, 2000, 1);
  double k_tau = 0.0, k_c = 0.0, k_k = 0.0;
  for (const PlantModel& stage : drawn.stages) {
    const Baseline &b = stage.baseline, &m = model.model.baseline;
    const double k = (b.k - m.k) / 5.0, tau = (b.tau - m.tau) / 0.5, c = (b.c_s - m.c_s) / 0.02;
    k_tau += k * tau, k_c += k * c, k_k += k * k;
  }
  EXPECT_NEAR(k_tau / k_k, -0.9, 0.05);
  EXPECT_NEAR(k_c / k_k, 0.0, 0.08) << "what no correlation is known of is independent";
}

TEST(Uncertainty, RepeatsRejectedDraws) {
  NotedModel model = noted_model();
  model.notes.values["k"] = {20.0, "test"};
  const auto stiff = [](const PlantModel& stage) { return stage.baseline.k > 140.0; };
  const UncertainStages all = uncertain_stages(model, 50, 1, stiff);
  EXPECT_EQ(all.stages.size(), 50U);
  for (const PlantModel& stage : all.stages) EXPECT_TRUE(stiff(stage));
  EXPECT_NEAR(all.refused, 50, 30);  // every other draw is softer
}

TEST(Uncertainty, IsReportedWhereAssumed) {
  const UncertainStages drawn = uncertain_stages(noted_model(), 3, 1);
  EXPECT_TRUE(drawn.assumed);
  EXPECT_FALSE(drawn.varied.empty());
}

}  // namespace
}  // namespace biopsy::sim::tuning
