// Fig. 8: the spring against a rigid pole, and hysteresis.
#include <gtest/gtest.h>

#include <filesystem>

#include "sim/paper/figures/figures.hpp"
#include "sim/paper/stack_height.hpp"
#include "tests/sim/paper/paper_stage.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim::paper {
namespace {

double hysteresis(const PaperModel& model) {
  return row_about(figure_8b(model), "largest hysteresis (MHS)")->ours;
}

PaperModel damped_bare_model() {
  PaperModel model = bare_paper_model();
  model.stage.baseline.c_s = 3.0;
  return model;
}

TEST(Figure8, AStageWithoutMemoryHasNoHysteresis) {
  EXPECT_LT(hysteresis(damped_bare_model()), 2.0);
}

// A play of w in each pouch's height opens the loop by 11 w wherever both branches are free.
TEST(Figure8, APlayOpensTheLoopByItsWidthTimesThePouches) {
  PaperModel model = damped_bare_model();
  model.stage.effects.zipping_hysteresis = ZippingHysteresis{0.2e-3, 0.0};
  const double expected = 100.0 * 11.0 * 0.2e-3 / stack_height(11.0);
  EXPECT_NEAR(hysteresis(model), expected, 0.2 * expected);
}

TEST(Figure8, StrainIsReferredToAStackMadeOfOilAndFilms) {
  EXPECT_NEAR(stack_height(11.0), 16.5e-3, 0.1e-3);
}

TEST(Figure8, ThePrintedStiffnessHasItsOwnRow) {
  const PaperFigure figure = figure_8a(damped_bare_model());
  const PaperRow* row = row_about(figure, std::string(kSpringQuantity));
  ASSERT_NE(row, nullptr);
  EXPECT_FALSE(row->ok);
  EXPECT_FALSE(row->note.empty());
  EXPECT_NEAR(row_about(figure, "sag of the spring")->paper, 35.0, 0.1);
}

// Calibration uses brief experiments. With friction a plate approaches its level slowly; a run cut short
// before that sees twice the ripple. A margin of 1 is 1 % of the level.
TEST(Figure8, TheBriefExperimentSeesTheRippleOfTheWholeOne) {
  const std::filesystem::path models = source_dir() / "sim/models";
  PaperModel model = read_paper_model(models / "calibrated.toml", models / "paper.toml");
  const std::vector<PaperRow> whole = figure_8a(model).rows;
  model.brief = true;
  const std::vector<PaperRow> brief = figure_8a(model).rows;
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(brief[i].margin, whole[i].margin, 0.2) << whole[i].quantity;
}

}  // namespace
}  // namespace biopsy::sim::paper
