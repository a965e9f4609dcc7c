// Fig. 6: the loss under DC follows from leakage and eq. (18) to (21).
#include <gtest/gtest.h>

#include <cmath>

#include "sim/paper/figures/figures.hpp"
#include "sim/plant/pouch.hpp"
#include "tests/sim/paper/paper_stage.hpp"

namespace biopsy::sim::paper {
namespace {

double rise_at(const Baseline& b, double t) {
  const double u_o = b.K * 6000.0 * std::exp(-t / b.tau);
  return equilibrium(b, pressure(b, u_o), 0.050 * b.g).H - b.H_0;
}

TEST(Figure6, LossOfAStageWithoutEffectsIsThatOfTheEquations) {
  PaperModel model = bare_paper_model();
  model.stage.baseline.tau = 12.0;
  const double lost =
      100.0 * (1.0 - rise_at(model.stage.baseline, 10.0) / rise_at(model.stage.baseline, 0.15));
  EXPECT_NEAR(row_about(figure_6(model), "50 um PI: displacement lost")->ours, lost, 2.0);
}

TEST(Figure6, AFilmThatDoesNotLeakLosesNothing) {
  PaperModel model = bare_paper_model();
  model.stage.baseline.c_s = 5.0;  // so that the peak is no overshoot
  model.pi25.tau = 1e6;
  EXPECT_NEAR(row_about(figure_6(model), "25 um PI: displacement lost")->ours, 0.0, 0.1);
}

TEST(Figure6, MaterialsDifferByTheirFilmOnly) {
  PaperModel model = bare_paper_model();
  const Baseline& b = model.stage.baseline;
  model.bopp25 = {b.K, b.tau, b.eps_film, b.d_film};
  const PaperFigure figure = figure_6(model);
  EXPECT_EQ(row_about(figure, "BOPP: displacement lost")->ours,
            row_about(figure, "50 um PI: displacement lost")->ours);
}

}  // namespace
}  // namespace biopsy::sim::paper
