// Halving the integrator's step must not change a reading by a micrometre.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

void expect_converged(PlantModel model, const std::string& name) {
  const std::vector<double> coarse = ramped_readings(model, 20000);
  model.internal_step /= 2;
  const double worst = largest_difference(coarse, ramped_readings(model, 20000));
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

TEST(Convergence, HalvingTheStepWithAnyEffectMovesNoSampleByAMicrometre) {
  for (const PlantModel& plain : {PlantModel{}, bare_mass(0.6, 140.0)})
    for_each_typical_effect([&]<class Effect>(const Effect& effect) {
      const std::string drive = plain.baseline.drive == Drive::Stack ? "stack_" : "force_";
      expect_converged(with_effect(plain, effect), drive + std::string(Effect::info.name));
    });
}

}  // namespace
}  // namespace biopsy::sim
