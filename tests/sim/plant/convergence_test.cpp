// Halving the integrator's step must not move the needle by a micrometre.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

std::vector<double> run(PlantModel model, double internal_step) {
  model.internal_step = internal_step;
  std::vector<double> x;
  PlantState state = at_rest(model);
  for (int k = 0; k < 20000; ++k) {
    state = step(model, state, {.voltage = ramps_and_flips(k)}, Seconds(1e-3));
    x.push_back(state.motion.x);
  }
  return x;
}

void expect_converged(const PlantModel& model, const std::string& name) {
  const auto coarse = run(model, model.internal_step), fine = run(model, model.internal_step / 2);
  double worst = 0.0;
  for (std::size_t k = 0; k < coarse.size(); ++k) worst = std::max(worst, std::abs(coarse[k] - fine[k]));
  EXPECT_LT(worst, 1e-6) << name;
  testing::Test::RecordProperty("worst_nm_" + name, static_cast<int>(worst * 1e9));
}

TEST(Convergence, HalvingTheStepOfTheBaselineMovesNoSampleByAMicrometre) {
  PlantModel model;
  for (const double weight : {0.0, 0.020, 0.050, 0.100, 0.260}) {
    model.weight = weight;
    expect_converged(model, "baseline_" + std::to_string(static_cast<int>(weight * 1e3)) + "_g");
  }
}

TEST(Convergence, HalvingTheStepOfTheRehearsalInTissueMovesNoSampleByAMicrometre) {
  PlantModel model = rehearsal_with_tissue();
  for (const double weight : {0.020, 0.050, 0.100}) {
    model.weight = weight;
    expect_converged(model, "rehearsal_" + std::to_string(static_cast<int>(weight * 1e3)) + "_g");
  }
}

TEST(Convergence, HalvingTheStepWithCoulombFrictionMovesNoSampleByAMicrometre) {
  for (const double friction : {0.02, 0.05, 0.2}) {
    PlantModel model;
    model.effects.coulomb_friction = CoulombFriction{friction};
    expect_converged(model, "coulomb_" + std::to_string(static_cast<int>(friction * 1e3)) + "_mN");
  }
}

}  // namespace
}  // namespace biopsy::sim
