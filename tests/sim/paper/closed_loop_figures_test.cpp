// Closed-loop figures respond to changes of the stage as physics requires.
#include <gtest/gtest.h>

#include <filesystem>
#include <string_view>

#include "sim/paper/figures/figures.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim::paper {
namespace {

PaperModel damped() {
  const std::filesystem::path models = source_dir() / "sim/models";
  PaperModel model = read_paper_model(models / "rehearsal.toml", models / "paper.toml");
  model.stage.baseline.tau_h = 0.3;
  model.stage.baseline.c_s = 1.7;
  model.stage.baseline.V0 = 1.2e-7;
  return model;
}

const PaperRow& row(const PaperFigure& figure, std::string_view begins) {
  for (const PaperRow& row : figure.rows)
    if (row.quantity.starts_with(begins)) return row;
  throw std::runtime_error("no row begins with " + std::string(begins));
}

TEST(PaperClosedLoop, EveryRowIsExplainedAndNamesItsFigure) {
  const PaperModel model = damped();
  for (const auto& figure :
       {figure_9a(model), figure_9b(model), figure_9c(model), figure_9d(model), figure_10(model),
        figure_11(model), figure_12(model), figure_13(model), beyond(model)}) {
    EXPECT_FALSE(figure.rows.empty());
    EXPECT_FALSE(figure.panels.empty());
    for (const PaperRow& row : figure.rows) {
      EXPECT_EQ(row.figure, figure.number);
      EXPECT_FALSE(row.note.empty()) << row.quantity;
    }
    for (const FigurePanel& panel : figure.panels)
      for (const FigureCurve& curve : panel.curves) {
        EXPECT_EQ(curve.x.size(), curve.y.size());
        EXPECT_LE(curve.x.size(), 2001U);
      }
  }
}

TEST(PaperClosedLoop, EdgesMakeTheErrorOverEverythingTheLargerOne) {
  const PaperFigure figure = figure_9a(damped());
  EXPECT_GT(row(figure, "RMSE over everything").ours, 3.0 * row(figure, "RMSE over settled").ours);
}

TEST(PaperClosedLoop, AStifferSpringYieldsLess) {
  PaperModel model = damped();
  const double soft = row(figure_11(model), "lowest").ours;
  model.stage.baseline.k *= 2.0;
  EXPECT_GT(row(figure_11(model), "lowest").ours, soft + 0.5);
}

TEST(PaperClosedLoop, ThePrintedStiffnessIsImpossible) {
  PaperModel model = damped();
  model.stage.baseline.k = 14.0;
  EXPECT_LT(row(figure_11(model), "lowest").ours, -5.0);
}

TEST(PaperClosedLoop, ResidualSetKeepsTheJointFromReturning) {
  PaperModel model = damped();
  model.joint.friction = 0.0;
  model.stage.effects.stribeck_friction.reset();
  model.stage.effects.zipping_hysteresis.reset();
  EXPECT_FALSE(row(figure_12(model), "does not return").ok);  // nothing holds it: it returns
  model.stage.effects.residual_set = ResidualSet{.floor_share = 0.15, .added_share = 0.0, .time = 60.0};
  EXPECT_TRUE(row(figure_12(model), "does not return").ok);
  EXPECT_TRUE(row(figure_12(model), "the voltage is 0 V").ok);
}

// Friction that breaks away at more than it slides with makes a slow sine stick and slip; without friction
// plate A follows evenly.
TEST(PaperClosedLoop, StickSlipNeedsFriction) {
  PaperModel model = damped();
  model.stage.baseline.c_s = 4.0;
  model.stage.effects.zipping_hysteresis.reset();
  model.stage.effects.stribeck_friction = StribeckFriction{};
  model.stage.effects.stribeck_friction->sliding = 0.02;
  model.stage.effects.stribeck_friction->breakaway = 0.15;
  EXPECT_TRUE(row(figure_9b(model), "plate A sticks").ok) << row(figure_9b(model), "plate A sticks").note;
  model.stage.effects.stribeck_friction.reset();
  EXPECT_FALSE(row(figure_9b(model), "plate A sticks").ok) << row(figure_9b(model), "plate A sticks").note;
}

TEST(PaperClosedLoop, AnUnpuncturedLiverIsReported) {
  PaperModel model = damped();
  EXPECT_TRUE(row(figure_13(model), "liver: punctured").ok);
  model.needle.tissue.back().surface.force = 10.0;
  EXPECT_FALSE(row(figure_13(model), "liver: punctured").ok);
}

TEST(PaperClosedLoop, ABiasBringsTheStageBackToItsZero) {
  const PaperFigure figure = beyond(damped());
  const PaperRow& biased = row(figure, "left 12 s after the return to 0: above a bias");
  EXPECT_LT(biased.ours, 0.5 * biased.paper);
}

TEST(PaperClosedLoop, FeedForwardBeatsThePapersFigures) {
  const std::filesystem::path models = source_dir() / "sim/models";
  const PaperFigure figure = beyond(read_paper_model(models / "calibrated.toml", models / "paper.toml"));
  EXPECT_LT(row(figure, "sine, RMSE over everything: feed-forward").ours, 0.211);
  EXPECT_LT(row(figure, "square wave, RMSE over settled windows: feed-forward").ours, 0.077);
}

}  // namespace
}  // namespace biopsy::sim::paper
