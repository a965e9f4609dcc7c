// Fig. 2: the closed forms are the circuit's, whatever the film.
#include <gtest/gtest.h>

#include "sim/paper/figures/figures.hpp"
#include "tests/sim/paper/paper_stage.hpp"

namespace biopsy::sim::paper {
namespace {

TEST(Figure2, ClosedFormsHoldForFastAndSlowFilms) {
  for (const double tau : {0.7, 6.9, 40.0}) {
    PaperModel model = bare_paper_model();
    model.stage.baseline.tau = tau;
    const PaperFigure figure = figure_2(model);
    EXPECT_EQ(figure.rows.size(), 5u);
    for (const PaperRow& row : figure.rows) EXPECT_TRUE(row.ok) << row.quantity << " at tau " << tau;
  }
}

TEST(Figure2, IsAboutTheCircuitAloneAndSeesNoEffectOfTheStage) {
  PaperModel model = bare_paper_model();
  model.stage.effects.charge_retention = ChargeRetention{0.4, 2.0};
  model.stage.effects.amplifier_lag = AmplifierLag{0.1, 0.0};
  for (const PaperRow& row : figure_2(model).rows) EXPECT_TRUE(row.ok) << row.quantity;
}

TEST(Figure2, DrawsAVoltageThatFallsUnderDcAndComesBackUnderReversals) {
  const PaperFigure figure = figure_2(bare_paper_model());
  const FigureCurve &dc = figure.panels[0].curves[1], &ac = figure.panels[1].curves[1];
  EXPECT_LT(dc.y.back(), 0.01);
  EXPECT_GT(std::abs(ac.y.back()), 0.5);
}

}  // namespace
}  // namespace biopsy::sim::paper
