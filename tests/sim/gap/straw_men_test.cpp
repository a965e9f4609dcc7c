// Figures of a run, and models without physics, on signals of known answer.
#include "sim/gap/residual/straw_men.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/gap/residual/run_fit.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/sim/gap/generator/hidden_physics.hpp"
#include "tests/sim/gap/recordings/rig.hpp"

namespace biopsy::hidden {
namespace {

using namespace sim::gap;

constexpr double kReading = 2e-6;  // m

Evidence fine_evidence(const sim::Dataset& data, const Rig& rig) {
  return prepare(data, sim::parse_model(rig_model(rig), "rig.toml"), {}, Sampling::Fine);
}

std::size_t rows_of(const Evidence& evidence) {
  std::size_t rows = 0;
  for (const EvidenceRun& run : evidence.runs) rows += run.rows.size();
  return rows;
}

TEST(StrawMen, SimulateALinearMechanismToTheNoiseAndNotOneWithAGrip) {
  const Rig linear{.damping_ratio = 0.3}, gripped{.damping_ratio = 0.3, .grip = 0.5};
  const sim::Dataset data = rig_recording(linear, kReading, 31), rough = rig_recording(gripped, kReading, 31);
  const double easy = straw_men(data, fine_evidence(data, linear)).front().rmse,
               hard = straw_men(rough, fine_evidence(rough, linear)).front().rmse;
  EXPECT_LT(easy, 0.1);  // mm, of some ten
  EXPECT_GT(hard, 5.0 * easy);
}

TEST(RunFits, OfNoiseAreWhiteAndOfAMissedPartAreNot) {
  const Rig rig;
  const sim::Dataset data = rig_recording(rig, kReading, 33);
  const Evidence evidence = fine_evidence(data, rig);
  Dice dice(5);
  std::vector<double> noise, slow;
  for (const EvidenceRun& run : evidence.runs)
    for (const Row& row : run.rows) {
      noise.push_back(kReading * dice.normal());
      slow.push_back(0.1 * row.measured);
    }
  ASSERT_EQ(noise.size(), rows_of(evidence));
  for (const RunFit& fit : run_fits(evidence, slow, noise)) {
    EXPECT_GT(fit.after_percent, 99.0);
    EXPECT_NEAR(fit.before_percent, 90.0, 3.0);  // the motion is not about 0
    EXPECT_LT(fit.whiteness, 2.0 * fit.bound);
    EXPECT_LT(fit.input_correlation, 2.0 * fit.bound);
  }
  for (const RunFit& fit : run_fits(evidence, noise, slow)) {
    EXPECT_GT(fit.whiteness, 0.9);
    EXPECT_GT(fit.input_correlation, 5.0 * fit.bound);
  }
}

TEST(Signals, HoldEveryRowAndBothModels) {
  const Rig rig;
  const sim::Dataset data = rig_recording(rig, kReading, 35);
  const Evidence evidence = fine_evidence(data, rig);
  const std::vector<double> before(rows_of(evidence), 3e-3), after(rows_of(evidence), 0.0);
  std::size_t rows = 0;
  for (const GapSignals& one : signals(evidence, before, after)) {
    for (std::size_t i = 0; i < one.time.size(); ++i, ++rows) {
      EXPECT_DOUBLE_EQ(one.after[i], one.measured[i]);
      EXPECT_NEAR(one.measured[i] - one.before[i], 3.0, 1e-9);  // mm
    }
  }
  EXPECT_EQ(rows, rows_of(evidence));
}

}  // namespace
}  // namespace biopsy::hidden
