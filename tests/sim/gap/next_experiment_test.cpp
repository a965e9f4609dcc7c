// The experiment that separates candidates, or none.
#include "sim/gap/select/next_experiment.hpp"

#include <gtest/gtest.h>

namespace biopsy::sim::gap {
namespace {

constexpr double kSensorNoise = 10e-6;  // m

PlantModel with_friction(double newtons) {
  PlantModel model;
  if (newtons > 0.0) model.effects.coulomb_friction = CoulombFriction{.force = newtons};
  return model;
}

PlantModel rig(double mass, double damping) {
  PlantModel model;
  model.baseline.drive = Drive::Force;
  model.baseline.m = mass;
  model.baseline.c_s = damping;
  model.baseline.k = 140.0;
  return model;
}

bool mentions(const NextExperiment& next, const std::string& words) {
  return next.sentence.find(words) != std::string::npos;
}

TEST(NextExperiment, ModelsThatDifferInFrictionOnlyAreSeparated) {
  const NextExperiment next = next_experiment({with_friction(0.0), with_friction(0.05)},
                                              {"nothing", "coulomb_friction"}, kSensorNoise);
  EXPECT_FALSE(next.name.empty());
  EXPECT_EQ(next.separates, (std::vector<std::string>{"nothing", "coulomb_friction"}));
  EXPECT_GT(next.difference, 0.010);  // mm
  EXPECT_TRUE(mentions(next, "nothing and coulomb_friction differ by")) << next.sentence;
}

TEST(NextExperiment, MoreFrictionMakesMoreDifference) {
  const auto difference = [](double newtons) {
    return next_experiment({with_friction(0.0), with_friction(newtons)}, {"a", "b"}, kSensorNoise).difference;
  };
  EXPECT_GT(difference(0.06), 1.5 * difference(0.02));
}

TEST(NextExperiment, IdenticalModelsYieldNoExperiment) {
  const NextExperiment next =
      next_experiment({with_friction(0.05), with_friction(0.05)}, {"one", "other"}, kSensorNoise);
  EXPECT_TRUE(next.name.empty());
  EXPECT_TRUE(next.separates.empty());
  EXPECT_EQ(next.difference, 0.0);
  EXPECT_TRUE(mentions(next, "separates one and other")) << next.sentence;
}

TEST(NextExperiment, ADifferenceBelowTheNoiseIsNoDifference) {
  const NextExperiment next = next_experiment({with_friction(0.0), with_friction(0.05)}, {"a", "b"}, 5e-3);
  EXPECT_TRUE(next.name.empty());
  EXPECT_GT(next.difference, 0.0);
  EXPECT_LT(next.difference, 5.0);
}

TEST(NextExperiment, NamesThePairThatIsNotSeparated) {
  const NextExperiment next = next_experiment({with_friction(0.0), with_friction(0.05), with_friction(0.05)},
                                              {"nothing", "coulomb", "its_copy"}, kSensorNoise);
  EXPECT_TRUE(next.name.empty());
  EXPECT_TRUE(mentions(next, "coulomb and its_copy")) << next.sentence;
}

TEST(NextExperiment, IsIndependentOfTheOrderOfCandidates) {
  const NextExperiment ab =
      next_experiment({with_friction(0.0), with_friction(0.05)}, {"a", "b"}, kSensorNoise);
  const NextExperiment ba =
      next_experiment({with_friction(0.05), with_friction(0.0)}, {"b", "a"}, kSensorNoise);
  EXPECT_EQ(ab.name, ba.name);
  EXPECT_EQ(ab.difference, ba.difference);
}

TEST(NextExperiment, AConstantErrorOfTheReadingIsItsOwnDifference) {
  // An offset of the sensor changes nothing but the reading, by itself, where the loop is open.
  PlantModel offset;
  offset.effects.sensor_offset = SensorOffset{.offset = 0.2e-3};
  const NextExperiment next =
      next_experiment({PlantModel{}, offset}, {"nothing", "sensor_offset"}, kSensorNoise);
  EXPECT_NEAR(next.difference, 0.2, 1e-3);
}

TEST(NextExperiment, StaysWithinTheStroke) {
  // Without friction the paper's loop moves the plate to 25 mm, where candidates differ most.
  EXPECT_NE(next_experiment({with_friction(0.0), with_friction(0.05)}, {"a", "b"}, kSensorNoise).name,
            "closed_loop_steps");
  PlantModel large = with_friction(0.0), larger = large;  // every program lifts these too far
  large.baseline.V0 *= 4.0;
  larger.baseline.V0 *= 5.0;
  const NextExperiment next = next_experiment({large, larger}, {"large", "larger"}, kSensorNoise);
  EXPECT_TRUE(next.name.empty());
  EXPECT_TRUE(mentions(next, "within the stroke")) << next.sentence;
}

TEST(NextExperiment, ForceRigsAreSeparatedInProportionToTheForce) {
  const auto next = [](double newtons) {
    return next_experiment({rig(0.080, 0.6), rig(0.090, 0.6)}, {"light", "heavy"}, kSensorNoise, newtons);
  };
  const NextExperiment one = next(0.5), two = next(1.0);
  EXPECT_FALSE(one.name.empty());
  EXPECT_EQ(one.name, two.name);
  EXPECT_NEAR(two.difference / one.difference, 2.0, 1e-6);  // linear plants
  EXPECT_NE(one.name, "slow_force_triangle");               // mass shows where things move fast
}

TEST(NextExperiment, NeedsTwoCandidates) {
  const NextExperiment next = next_experiment({PlantModel{}}, {"nothing"}, kSensorNoise);
  EXPECT_TRUE(next.name.empty());
  EXPECT_FALSE(next.sentence.empty());
}

}  // namespace
}  // namespace biopsy::sim::gap
