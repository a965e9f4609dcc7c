// When a spring filters: closed form, and the simulated stage against it.
#include "sim/paper/figures/series_spring.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "sim/paper/figures/figures.hpp"
#include "tests/sim/paper/paper_stage.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kMass = 0.08, kSpring = 140.0;

// Textbook of vibration isolation: |T| = 1/|1 - r^2| with r = f/f_0.
TEST(SeriesSpring, WithoutDampingFollowsTheTextbook) {
  const double f_0 = resonance(kMass, kSpring);
  EXPECT_NEAR(f_0, 6.658, 1e-3);
  for (const double r : {0.1, 0.5, 2.0, 5.0})
    EXPECT_NEAR(transmission(kMass, kSpring, 0.0, 0.0, r * f_0), 1.0 / std::abs(1.0 - r * r), 1e-9) << r;
  EXPECT_NEAR(transmission(kMass, kSpring, 0.0, 0.0, std::numbers::sqrt2 * f_0), 1.0, 1e-9);
}

// Damping beside the spring carries motion past it, damping to the frame holds it.
TEST(SeriesSpring, DampingToTheFrameHoldsAndDampingBesideTheSpringPasses) {
  const double fast = 5.0 * resonance(kMass, kSpring), plain = transmission(kMass, kSpring, 0.0, 0.0, fast);
  EXPECT_GT(transmission(kMass, kSpring, 3.0, 0.0, fast), plain);
  EXPECT_LT(transmission(kMass, kSpring, 0.0, 3.0, fast), plain);
}

// A square wave of 2 Hz moves plate B at 4 Hz. 10 N/m with 80 g resonate at 1.8 Hz and filter that, 140 N/m
// at 6.7 Hz do not; friction holds plate A with either.
TEST(SeriesSpring, TheSimulatedStageFiltersWithASoftSpringOnlyOrByFriction) {
  PaperModel model = bare_paper_model();
  model.stage.baseline.c_s = 1.0;
  const auto shown = [&](double k) {
    model.stage.baseline.k = k;
    return *row_about(figure_8a(model), "plate A's motion over plate B's");
  };
  EXPECT_LT(shown(10.0).paper, 0.5);
  EXPECT_GT(shown(140.0).paper, 1.0);
  EXPECT_NEAR(shown(140.0).ours, shown(140.0).paper, 1e-9) << "no friction in this model";
  model.stage.effects.coulomb_friction = CoulombFriction{.force = 0.1};
  EXPECT_LT(shown(140.0).ours, 0.3) << "friction";
  EXPECT_GT(shown(140.0).paper, 1.0) << "without it";
}

TEST(Figure4, TheOilThatMovesIsFarLessThanThePrinted) {
  const PaperFigure figure = figure_4(bare_paper_model());
  EXPECT_FALSE(row_about(figure, "oil of a pouch")->ok);
  PaperModel printed = bare_paper_model();
  printed.stage.baseline.V0 = 3.2e-6;
  EXPECT_TRUE(row_about(figure_4(printed), "oil of a pouch")->ok);
  // C2 of the baseline, 0.5 nF by K = 0.8 and C1 = 2 nF, is below what its films and oil give.
  const PaperRow& C2 = *row_about(figure, "C2 by the films");
  EXPECT_NEAR(C2.ours, 0.5, 1e-9);
  EXPECT_GT(C2.paper, C2.ours);
}

}  // namespace
}  // namespace biopsy::sim::paper
