// The electrical part against the paper's closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/plant/plant.hpp"

namespace biopsy::sim {
namespace {

TEST(Leakage, StepResponseIsEquationSix) {
  const PlantModel model;
  PlantState state = at_rest(model);
  for (int k = 1; k <= 20000; ++k) {
    state = step(model, state, {.voltage = 6000.0}, Seconds(1e-3));
    const double expected = 0.80 * 6000.0 * std::exp(-k * 1e-3 / 6.9);
    ASSERT_NEAR(state.u_o, expected, 1e-9 * expected);
  }
}

class SquareWave : public testing::TestWithParam<int> {};  // ms between flips

// K1 = 2K/(1 + e^(Pa)), K2 = 2K e^(Pa)/(1 + e^(Pa)) with P = -1/tau and a the time between flips.
TEST_P(SquareWave, SettlesBetweenTheBoundsOfEquationsSixteenAndSeventeen) {
  const PlantModel model;
  const double decay = std::exp(-GetParam() * 1e-3 / 6.9);
  const double upper = 2 * 0.80 / (1 + decay) * 5000.0, lower = upper * decay;
  PlantState state = at_rest(model);
  double sign = 1.0, first = 0.0, last = 0.0;
  // The way there dies out as e^(-t/tau): 26 tau leave 1e-11 of it.
  const int flips = 180000 / GetParam() + 2;
  for (int flip = 0; flip < flips; ++flip, sign = -sign)
    for (int k = 0; k < GetParam(); ++k) {
      const PlantState before = state;
      state = step(model, state, {.voltage = sign * 5000.0}, Seconds(1e-3));
      if (k == 0) first = sign * (before.u_o + 0.80 * (sign * 5000.0 - before.u_i));
      last = sign * state.u_o;
    }
  EXPECT_NEAR(first, upper, 1e-9 * upper);
  EXPECT_NEAR(last, lower, 1e-9 * lower);
}

INSTANTIATE_TEST_SUITE_P(HalfPeriod_ms, SquareWave, testing::Values(50, 250, 2500));

TEST(Leakage, DoesNotDependOnHowTheTimeIsCut) {
  const PlantModel model;
  PlantState coarse = step(model, at_rest(model), {.voltage = 3000.0}, Seconds(0.05));
  PlantState fine = at_rest(model);
  for (int k = 0; k < 5000; ++k) fine = step(model, fine, {.voltage = 3000.0}, Seconds(1e-5));
  EXPECT_NEAR(coarse.u_o, fine.u_o, 1e-9 * fine.u_o);
}

// Current leaves the amplifier through C1: jump of u_i - u_o, then its growth as u_o leaks.
TEST(Current, ChargeOfAStepIsC1TimesTheVoltageAcrossIt) {
  const PlantModel model;
  PlantState state = step(model, at_rest(model), {.voltage = 4000.0}, Seconds(1e-3));
  EXPECT_NEAR(state.charge, 2.0e-9 * (4000.0 - state.u_o), 1e-12 * state.charge + 1e-18);
  double total = state.charge;
  for (int k = 0; k < 60000; ++k) {
    state = step(model, state, {.voltage = 4000.0}, Seconds(1e-3));
    total += state.charge;
  }
  EXPECT_NEAR(total, 2.0e-9 * (4000.0 - state.u_o), 1e-9 * total);
}

TEST(Current, BetweenSamplesIsTheLeakSeenThroughC1) {
  const PlantModel model;
  const PlantState state = step(model, at_rest(model), {.voltage = 4000.0}, Seconds(1e-3));
  EXPECT_NEAR(current(model, state), 2.0e-9 * state.u_o / 6.9, 1e-18);
  const PlantState next = step(model, state, {.voltage = 4000.0}, Seconds(1e-6));
  EXPECT_NEAR(next.charge / 1e-6, current(model, state), 1e-6 * current(model, state));
}

}  // namespace
}  // namespace biopsy::sim
