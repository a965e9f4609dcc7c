// Creep and set of the pouches against arithmetic.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

PlantModel lossless() {
  PlantModel model;
  model.baseline.tau = 1e12;  // a held voltage stays
  return model;
}

double deflection(const PlantModel& model, const PlantState& state) {
  return state.motion.H - model.baseline.H_0;
}

TEST(PouchCreep, AddsItsShareOfTheDeflectionAfterManyTimes) {
  const PlantModel model = with_effect(lossless(), PouchCreep{.share = 0.2, .time = 0.5, .log_share = 0.0});
  const PlantState state = charged(model, at_rest(model), 3000.0, 15000);
  const double d = deflection(model, state);
  EXPECT_NEAR(state_of<PouchCreep>(state), 0.2 * d, 1e-5 * d);
  EXPECT_NEAR(plate_b(model, state), 11 * 1.2 * d, 1e-5 * d);
  EXPECT_NEAR(state.motion.x, plate_b(model, state), 1e-7);  // the spring stands unstretched
  const PlantState recovered = charged(model, state, 0.0, 15000);
  EXPECT_NEAR(state_of<PouchCreep>(recovered), 0.0, 1e-9);  // and it recovers
}

TEST(PouchCreep, OfLogarithmicKindGrowsByTheSameInEachDecade) {
  const PouchCreep creep{.share = 0.1, .time = 0.2, .log_share = 1.0};
  double c = 0.0, t = 0.0;
  const double d = 1e-3, h = 1e-4;
  for (; t < 20.0; t += h) {
    const double half = c + 0.5 * h * creep.rate(d, c);
    c += h * creep.rate(d, half);
  }
  EXPECT_NEAR(c, 0.1 * d * std::log1p(t / 0.2), 1e-4 * d);
}

TEST(PouchCreep, OfLogarithmicKindKeepsStillWithoutDeflection) {
  const PouchCreep creep{.share = 0.1, .time = 0.2, .log_share = 1.0};
  EXPECT_EQ(creep.rate(0.0, 0.0), 0.0);
  EXPECT_EQ(creep.rate(0.0, 1e-4), 0.0);
  EXPECT_EQ(creep.rate(1e-30, 1e-4), 0.0);
}

TEST(ResidualSet, IsNothingAtTheFirstLoading) {
  PlantModel model = lossless(), plain = lossless();
  model.effects.residual_set = ResidualSet{.floor_share = 0.3, .added_share = 0.2, .time = 1e9};
  PlantState a = at_rest(model), b = at_rest(plain);
  for (int k = 0; k < 20000; ++k) {  // slowly enough that H never swings back
    a = step(model, a, {.voltage = 0.15 * k}, Seconds(1e-3));
    b = step(plain, b, {.voltage = 0.15 * k}, Seconds(1e-3));
    ASSERT_NEAR(a.motion.x, b.motion.x, 20e-6) << k;
  }
}

TEST(ResidualSet, KeepsItsSharesOfTheLargestDeformationAndForgetsThem) {
  const PlantModel model =
      with_effect(lossless(), ResidualSet{.floor_share = 0.3, .added_share = 0.2, .time = 20.0});
  PlantState state = charged(model, at_rest(model), 3000.0, 3000);
  const double before = state_of<ResidualSet>(state).largest;
  EXPECT_GT(before, 0.3e-3);
  state = charged(model, state, 0.0, 2000);
  const double M = state_of<ResidualSet>(state).largest;
  EXPECT_NEAR(deflection(model, state), 0.3 * M, 2e-3 * M);  // the floor sinks, oil follows 30 ms later
  EXPECT_NEAR(plate_b(model, state), 11 * (0.3 * M + 0.2 * 0.7 * M), 11 * 2e-3 * M);
  state = charged(model, state, 0.0, 20000);
  EXPECT_NEAR(state_of<ResidualSet>(state).largest, M * std::exp(-1.0), 1e-6 * M);
}

TEST(ResidualSet, NeverRemembersLessThanItStandsAt) {
  const PlantModel model =
      with_effect(lossless(), ResidualSet{.floor_share = 0.01, .added_share = 0.0, .time = 0.1});
  const PlantState state = charged(model, at_rest(model), 3000.0, 5000);
  EXPECT_EQ(state_of<ResidualSet>(state).largest, deflection(model, state));
}

}  // namespace
}  // namespace biopsy::sim
