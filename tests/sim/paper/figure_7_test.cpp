// Fig. 7: oscillation under square waves, against the closed forms (16) and (17).
#include <gtest/gtest.h>

#include <cmath>

#include "sim/paper/figures/figures.hpp"
#include "sim/paper/open_loop.hpp"
#include "sim/plant/pouch.hpp"
#include "tests/sim/paper/paper_stage.hpp"

namespace biopsy::sim::paper {
namespace {

TEST(Figure7, SlowOscillationIsTheEquilibriumBetweenTheTwoLimits) {
  PaperModel model = bare_paper_model();
  model.stage.baseline.c_s = 5.0;  // no overshoot
  const Baseline& b = model.stage.baseline;
  const double left = std::exp(-10.0 / b.tau), upper = 6000.0 * 2.0 * b.K / (1.0 + left);
  const double F = 0.130 * b.g;
  const double expected =
      1e3 * 11.0 * (equilibrium(b, pressure(b, upper), F).H - equilibrium(b, pressure(b, upper * left), F).H);
  const OpenLoopRun run =
      run_open_loop(plate_on_stack(model.stage, 11.0, 0.100),
                    {.amplitude = 6000.0, .frequency = 0.05, .settle = 60.0, .watch = 20.0}, false);
  EXPECT_NEAR(peak_to_peak(run.displacement), expected, 0.03 * expected);
}

TEST(Figure7, OscillatesAtTwiceTheDrivesFrequency) {
  for (const PaperRow& row : figure_7a(bare_paper_model()).rows)
    EXPECT_TRUE(!row.quantity.starts_with("oscillates") || row.ok) << row.quantity << row.note;
}

TEST(Figure7, FallsWithFrequencyAndLevelsOff) {
  for (const PaperRow& row : figure_7b(bare_paper_model()).rows)
    EXPECT_TRUE(row.quantity.find("fall") == std::string::npos || row.ok) << row.quantity << row.note;
}

// The same friction, once rigid until it breaks away and once elastic before it slides.
TEST(Figure7, ARipplePassesFrictionThatIsElasticBeforeItSlides) {
  PaperModel model = bare_paper_model();
  model.brief = true;
  model.stage.effects.coulomb_friction = CoulombFriction{.force = 0.1};
  EXPECT_FALSE(row_about(figure_7a(model), "10 Hz")->ok);
  model.stage.effects.coulomb_friction.reset();
  model.stage.effects.hysteretic_spring = HystereticSpring{.stiffness = 2e3, .yield = 0.05e-3};
  EXPECT_TRUE(row_about(figure_7a(model), "10 Hz")->ok);
}

TEST(OpenLoop, OneSliderHasHalfOfTheGuidesFriction) {
  PlantModel stage = bare_paper_model().stage;
  EXPECT_EQ(guide_friction(stage), 0.0);
  stage.effects.coulomb_friction = CoulombFriction{.force = 0.04};
  stage.effects.hysteretic_spring = HystereticSpring{.stiffness = 2e3, .yield = 0.03e-3};
  EXPECT_DOUBLE_EQ(guide_friction(stage), 0.10);
  EXPECT_DOUBLE_EQ(guide_friction(plate_on_stack(stage, 11.0, 0.020)), 0.05);
}

void expect_same_without_settling(const PlantModel& stage) {
  const OpenLoopDrive drive{.amplitude = 6000.0, .frequency = 0.5, .settle = 80.0, .watch = 2.0};
  const OpenLoopRun full = run_open_loop(stage, drive, false), brief = run_open_loop(stage, drive, true);
  ASSERT_EQ(full.time.size(), brief.time.size());
  for (std::size_t i = 0; i < full.time.size(); ++i) {
    EXPECT_NEAR(full.time[i], brief.time[i], 1e-9);
    EXPECT_NEAR(full.displacement[i], brief.displacement[i], 2e-3) << "at " << full.time[i] << " s";
  }
}

TEST(OpenLoop, SettlingMayBeSkippedWhereVoltageIsTheOnlyMemory) {
  PlantModel stage = plate_on_stack(bare_paper_model().stage, 11.0, 0.050);
  expect_same_without_settling(stage);
  stage.effects.charge_retention = ChargeRetention{0.4, 0.8};
  expect_same_without_settling(stage);
  stage.effects.charge_retention = ChargeRetention{0.4, stage.baseline.tau};
  expect_same_without_settling(stage);
}

TEST(OpenLoop, RigidPoleMovesPlateAWithPlateB) {
  const PaperModel model = bare_paper_model();
  const OpenLoopRun run =
      run_open_loop(with_rigid_pole(model.stage),
                    {.amplitude = 6000.0, .frequency = 2.0, .settle = 5.0, .watch = 1.0}, false);
  for (std::size_t i = 0; i < run.time.size(); ++i)
    EXPECT_NEAR(run.displacement[i], run.plate_b[i], 0.02 * run.plate_b[i]);
}

TEST(OpenLoop, RigidPoleGivesTheSameWithHalfTheStep) {
  PlantModel coarse = with_rigid_pole(bare_paper_model().stage), fine = coarse;
  fine.internal_step *= 0.5;
  const OpenLoopDrive drive{.amplitude = 6000.0, .frequency = 2.0, .settle = 0.0, .watch = 2.0};
  const OpenLoopRun a = run_open_loop(coarse, drive, false), b = run_open_loop(fine, drive, false);
  for (std::size_t i = 0; i < a.time.size(); ++i) EXPECT_NEAR(a.displacement[i], b.displacement[i], 0.02);
}

}  // namespace
}  // namespace biopsy::sim::paper
