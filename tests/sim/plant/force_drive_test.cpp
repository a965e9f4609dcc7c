// drive = "force": a damped oscillator that never saw a HASEL, against its closed form.
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
  PlantState state = at_rest(model);
  for (int k = 0; k < 5000; ++k)
    state = step(model, state, {.force = 0.5, .external_force = 0.2}, Seconds(1e-3));
  EXPECT_NEAR(state.motion.x, 0.3 / 140.0, 1e-12);
}

TEST(ForceDrive, KnowsNeitherVoltageNorGravityNorPouches) {
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

}  // namespace
}  // namespace biopsy::sim
