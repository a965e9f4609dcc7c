// drive = "force": a damped oscillator against its closed form; set_state and fastest_rate.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

// Response of m x'' + c x' + k x = F from rest.
double step_response(double m, double c, double k, double F, double t) {
  const double omega = std::sqrt(k / m), zeta = c / (2 * std::sqrt(k * m));
  if (zeta < 1) {
    const double damped = omega * std::sqrt(1 - zeta * zeta);
    return F / k *
           (1 - std::exp(-zeta * omega * t) *
                    (std::cos(damped * t) + zeta * omega / damped * std::sin(damped * t)));
  }
  const double root = std::sqrt(zeta * zeta - 1), slow = -omega * (zeta - root),
               fast = -omega * (zeta + root);
  return F / k * (1 + (fast * std::exp(slow * t) - slow * std::exp(fast * t)) / (slow - fast));
}

double worst_error(double damping, double internal_step) {
  PlantModel model = bare_mass(damping, 140.0);
  model.internal_step = internal_step;
  PlantState state = at_rest(model);
  double worst = 0.0;
  for (int k = 1; k <= 2000; ++k) {
    state = step(model, state, {.force = 0.7}, Seconds(1e-3));
    worst = std::max(worst, std::abs(state.motion.x - step_response(0.080, damping, 140.0, 0.7, k * 1e-3)));
  }
  return worst;
}

TEST(ForceDrive, FollowsTheDampedOscillatorsClosedForm) {
  for (const double damping : {0.6, 2.0, 12.0}) {
    EXPECT_LT(worst_error(damping, 1e-3), 2e-6) << damping;
    EXPECT_LT(worst_error(damping, 1e-4), 2e-9) << damping;
  }
}

TEST(ForceDrive, IsOfThirdOrder) {
  const double ratio = worst_error(0.6, 1e-3) / worst_error(0.6, 0.5e-3);
  EXPECT_NEAR(std::log2(ratio), 3.0, 0.2);
}

TEST(ForceDrive, RestsWhereTheForcesCancel) {
  const PlantModel model = bare_mass(5.0, 140.0);
  const PlantState state = held(model, at_rest(model), {.force = 0.5, .external_force = 0.2}, 5000);
  EXPECT_NEAR(state.motion.x, 0.3 / 140.0, 1e-12);
}

TEST(ForceDrive, DoesNotDependOnVoltageGravityOrPouches) {
  PlantModel model = bare_mass(0.6, 140.0), other = model;
  other.baseline.g = 0.0;
  other.baseline.V0 = 1e-6;
  other.weight = 3.0;
  PlantState a = at_rest(model), b = at_rest(other);
  for (int k = 0; k < 500; ++k) {
    a = step(model, a, {.force = 0.5}, Seconds(1e-3));
    b = step(other, b, {.voltage = 6000.0, .force = 0.5}, Seconds(1e-3));
    ASSERT_EQ(a.motion.x, b.motion.x);
  }
  EXPECT_EQ(b.motion.H, other.baseline.H_0);
}

TEST(SetState, PutsAForceDrivenMassWhereAFreshOscillatorWouldBe) {
  const PlantModel model = bare_mass(0.0, 140.0);
  PlantState state = at_rest(model);
  set_state(model, state, 0.4e-3, 0.03);
  EXPECT_EQ(displacement_reading(model, state), 0.4e-3);
  state = pushed(model, state, 0.0, 100);
  const double w = std::sqrt(140.0 / 0.080);
  EXPECT_NEAR(state.motion.x, 0.4e-3 * std::cos(0.1 * w) + 0.03 / w * std::sin(0.1 * w), 1e-7);
}

TEST(SetState, TakesPlateBAlongSoThatTheSpringKeepsItsStretch) {
  PlantModel model;
  model.baseline.tau = 1e12;
  PlantState state = at_rest(model);
  for (int k = 0; k < 5000; ++k)
    state = step(model, state, {.voltage = 3000.0, .external_force = 0.1}, Seconds(1e-3));
  const double stretch = plate_b(model, state) - state.motion.x;
  set_state(model, state, state.motion.x - 0.5e-3, 0.0);
  EXPECT_NEAR(plate_b(model, state) - state.motion.x, stretch, 1e-12);
  set_state(model, state, -5e-3, 0.0);  // further than the pouches can
  EXPECT_EQ(state.motion.H, model.baseline.H_0);
}

TEST(SetState, LeavesPlayAndSensorAsSteadyMotionDoes) {
  PlantModel model = bare_mass();
  model.effects.backlash = Backlash{0.2e-3};
  model.effects.sensor_lag = SensorLag{.time = 4e-3, .delay = 6e-3};
  PlantState state = at_rest(model);
  set_state(model, state, 1e-3, 0.02);
  for (int k = 0; k < 20; ++k) {
    const double expected = 1e-3 + 0.02 * k * 1e-3 - 0.1e-3 - 0.02 * 10e-3;
    ASSERT_NEAR(displacement_reading(model, state), expected, 1e-12) << k;
    state = step(model, state, {}, Seconds(1e-3));
  }
}

TEST(FastestRate, IsNoLessThanTheEigenvaluesOfMechanicsAndContact) {
  PlantModel model = bare_mass(2.0, 140.0);
  EXPECT_GE(fastest_rate(model), std::sqrt(140.0 / 0.080));
  EXPECT_LE(fastest_rate(model), 2 * std::sqrt(140.0 / 0.080));
  model.effects.end_stop = EndStop{1e-3, 1e6, 0.0};
  EXPECT_GE(fastest_rate(model), std::sqrt((1e6 + 140.0) / 0.080));
  model = bare_mass(1e3, 1e6);  // ten tonnes on a stiff base
  model.baseline.m = 1e4;
  EXPECT_NEAR(fastest_rate(model), 10.0 + 0.1, 1e-9);
  EXPECT_GE(fastest_rate(PlantModel{}), 1.0 / 0.030);
}

}  // namespace
}  // namespace biopsy::sim
