// step() is a function of its arguments alone.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

void expect_same(const PlantState& a, const PlantState& b) {
  EXPECT_EQ(a.u_i, b.u_i);
  EXPECT_EQ(a.u_o, b.u_o);
  EXPECT_EQ(a.motion.H, b.motion.H);
  EXPECT_EQ(a.motion.x, b.motion.x);
  EXPECT_EQ(a.motion.v, b.motion.v);
  EXPECT_EQ(a.motion.integrated, b.motion.integrated);
  EXPECT_EQ(a.motion.crept, b.motion.crept);
  EXPECT_EQ(state_of<ZippingHysteresis>(a).H, state_of<ZippingHysteresis>(b).H);
  EXPECT_EQ(a.x_max, b.x_max);
  EXPECT_EQ(state_of<SensorLag>(a).lagged, state_of<SensorLag>(b).lagged);
}

PlantState advanced(const PlantModel& model, PlantState state, int from, int to) {
  for (int k = from; k < to; ++k) state = step(model, state, {.voltage = ramps_and_flips(k)}, Seconds(1e-3));
  return state;
}

TEST(Step, SameArgumentsGiveTheSameStateToTheBit) {
  const PlantModel model = rehearsal_with_tissue();
  const PlantState before = advanced(model, at_rest(model), 0, 3000);
  const PlantInputs inputs{.voltage = 4000.0, .external_force = 0.1};
  const PlantState once = step(model, before, inputs, Seconds(1e-3));
  advanced(model, at_rest(model), 0, 1000);  // another run in between leaves nothing behind
  const PlantState again = step(model, before, inputs, Seconds(1e-3));
  expect_same(once, again);
  EXPECT_EQ(once.charge, again.charge);
  EXPECT_EQ(displacement_reading(model, once), displacement_reading(model, again));
}

TEST(Step, AResumedRunIsTheSameRun) {
  const PlantModel model = rehearsal_with_tissue();
  const PlantState whole = advanced(model, at_rest(model), 0, 6000);
  const PlantState half = advanced(model, at_rest(model), 0, 3017);
  const PlantModel copy = model;
  expect_same(advanced(copy, half, 3017, 6000), whole);
}

TEST(Step, TwoMillisecondsAtOnceAreTwoTimesOneMillisecond) {
  const PlantModel model = rehearsal_with_tissue();
  PlantState once = at_rest(model), twice = once;
  for (int k = 0; k < 5000; ++k) {
    const PlantInputs inputs{.voltage = ramps_and_flips(2 * k)};
    once = step(model, once, inputs, Seconds(2e-3));
    twice = step(model, step(model, twice, inputs, Seconds(1e-3)), inputs, Seconds(1e-3));
  }
  expect_same(once, twice);
}

TEST(Step, ChargeOfEveryCutOfAStepAddsUp) {
  const PlantModel model;
  const PlantState before = advanced(model, at_rest(model), 0, 500);
  const PlantInputs inputs{.voltage = -2000.0};
  const double whole = step(model, before, inputs, Seconds(0.02)).charge;
  PlantState state = before;
  double sum = 0.0;
  for (int k = 0; k < 80; ++k) {
    state = step(model, state, inputs, Seconds(0.25e-3));
    sum += state.charge;
  }
  EXPECT_NEAR(sum, whole, 1e-9 * std::abs(whole));
}

TEST(Step, NoiseOfTheReadingDoesNotAffectTheMotion) {
  PlantModel loud = rehearsal_with_tissue(), quiet = loud;
  loud.effects.sensor_noise->std = 1e-3;
  quiet.effects.sensor_noise.reset();
  loud.noise_seed = 99;
  expect_same(advanced(loud, at_rest(loud), 0, 4000), advanced(quiet, at_rest(quiet), 0, 4000));
}

}  // namespace
}  // namespace biopsy::sim
