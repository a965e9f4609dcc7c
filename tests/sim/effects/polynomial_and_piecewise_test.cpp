// Stiffness and damping that are polynomials or linear in pieces, films of another power of the voltage, and
// pouches that open slower than they close, each against its closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

constexpr double kSpring = 140.0;  // N/m

TEST(AsymmetricSpring, BalancesForceByAParabolaInEitherDirection) {
  const PlantModel model = with_effect(bare_mass(5.0, kSpring), AsymmetricSpring{4e3});
  for (const double force : {0.5, -0.5}) {
    const double x = pushed(model, at_rest(model), force, 10000).motion.x;
    EXPECT_NEAR(kSpring * x - 4e3 * x * x, force, 1e-9);
  }
}

TEST(AsymmetricSpring, WithTheCubicTermIsAPolynomial) {
  PlantModel model = with_effect(bare_mass(5.0, kSpring), AsymmetricSpring{-9e3});
  model.effects.spring_hardening = SpringHardening{2e6};
  for (const double force : {0.8, -0.3}) {
    const double x = pushed(model, at_rest(model), force, 10000).motion.x;
    EXPECT_NEAR(kSpring * x + 9e3 * x * x + 2e6 * x * x * x, force, 1e-9);
  }
}

TEST(PiecewiseSpring, HasItsOtherStiffnessBeyondItsPlaceInEitherDirection) {
  for (const double change : {300.0, -60.0}) {
    const PlantModel model = with_effect(bare_mass(5.0, kSpring), PiecewiseSpring{change, 2e-3});
    EXPECT_NEAR(pushed(model, at_rest(model), 0.2, 10000).motion.x, 0.2 / kSpring, 1e-9);  // 1.4 mm
    for (const double force : {0.5, -0.5}) {
      const double beyond = (std::abs(force) - kSpring * 2e-3) / (kSpring + change);
      EXPECT_NEAR(pushed(model, at_rest(model), force, 20000).motion.x, std::copysign(2e-3 + beyond, force),
                  1e-9);
    }
  }
}

// On a stage both springs are the one between the plates, which a push from outside compresses.
TEST(Springs, OfTheStackActOnTheStretchBetweenThePlates) {
  PlantModel model;
  model.baseline.tau = 1e12;
  model.effects.asymmetric_spring = AsymmetricSpring{5e4};
  model.effects.piecewise_spring = PiecewiseSpring{200.0, 0.4e-3};
  const PlantState state = held(model, at_rest(model), {.voltage = 3000.0, .external_force = 0.2}, 10000);
  const double s = plate_b(model, state) - state.motion.x;
  EXPECT_GT(s, 0.4e-3);
  EXPECT_NEAR(kSpring * s + 5e4 * s * s + 200.0 * (s - 0.4e-3), 0.2, 1e-6);
}

TEST(DirectionalDamping, LimitsTheSpeedInItsDirectionOnly) {
  for (const double more : {15.0, -15.0}) {
    const PlantModel model = with_effect(bare_mass(5.0), DirectionalDamping{more});
    const double up = more > 0.0 ? 20.0 : 5.0, down = more > 0.0 ? 5.0 : 20.0;
    EXPECT_NEAR(pushed(model, at_rest(model), 0.1, 2000).motion.v, 0.1 / up, 1e-9);
    EXPECT_NEAR(pushed(model, at_rest(model), -0.1, 2000).motion.v, -0.1 / down, 1e-9);
  }
}

TEST(DirectionalDamping, TakesTheWorkOfACheckValveFromACycle) {
  const DirectionalDamping valve{-8.0};
  double work = 0.0;
  constexpr int kCycle = 100000;
  constexpr double kTwoPi = 6.283185307179586, kSpeed = 0.03;
  for (int i = 0; i < kCycle; ++i) {
    const double v = kSpeed * std::cos(kTwoPi * i / kCycle);
    work += valve.load({.x = 0.0, .v = v, .x_max = 0.0, .time = 0.0, .on_stack = false}) * v / kCycle;
  }
  EXPECT_NEAR(work, 0.25 * 8.0 * kSpeed * kSpeed, 1e-9);  // half of that of a damper in both
}

// At 0 V the load opens the pouches: their height falls as exp(-t/((1 + share) tau_h)), whatever it was.
TEST(SlowUnzipping, LetsTheStackFallInItsOwnTime) {
  for (const double share : {2.0, 0.4, -0.5}) {
    PlantModel model = with_effect(PlantModel{}, SlowUnzipping{share});
    const Baseline& b = model.baseline;
    const PlantState up = charged(model, at_rest(model), 3000.0, 2000);
    const double time = (1.0 + share) * b.tau_h;
    PlantModel discharged = model;
    discharged.baseline.tau = 1e-4;  // no voltage is left on the stack
    const PlantState before = charged(discharged, up, 0.0, 5);
    const PlantState after = charged(discharged, before, 0.0, 30);
    EXPECT_NEAR((after.motion.H - b.H_0) / (before.motion.H - b.H_0), std::exp(-0.030 / time), 1e-4) << share;
  }
}

TEST(SlowUnzipping, LeavesTheRiseAsItIs) {
  PlantModel plain;
  plain.baseline.tau = 1e12;
  const PlantModel slow = with_effect(plain, SlowUnzipping{3.0});
  for (const int ms : {5, 20, 60})  // until plate A's ringing lifts the load off again
    EXPECT_NEAR(charged(slow, at_rest(slow), 2500.0, ms).motion.H,
                charged(plain, at_rest(plain), 2500.0, ms).motion.H, 2e-6)
        << ms;
}

// P of eq. (21) at 1 kV on the stack, and in proportion to |u|^(2 - deficit): another voltage of a plain
// stack.
TEST(VoltagePower, PullsAsThePowerSays) {
  PlantModel plain;
  plain.baseline.tau = 1e12;
  for (const double deficit : {0.5, 0.1, -0.4})
    for (const double u : {600.0, -1000.0, 2400.0}) {
      const PlantModel model = with_effect(plain, VoltagePower{deficit});
      const double same = std::sqrt(std::pow(std::abs(u), 2.0 - deficit) * std::pow(1e3, deficit));
      EXPECT_NEAR(charged(model, at_rest(model), u / plain.baseline.K, 3000).motion.x,
                  charged(plain, at_rest(plain), same / plain.baseline.K, 3000).motion.x, 1e-9)
          << deficit << " " << u;
    }
}

TEST(VoltagePower, IsInvertedByTheVoltageThatActsSo) {
  for (const double deficit : {0.5, 0.0, -0.4})
    for (const double u : {20.0, 1000.0, 5200.0}) {
      const VoltagePower power{deficit};
      EXPECT_NEAR(power.acting(power.voltage_for(u)), u, 1e-9 * u);
    }
}

}  // namespace
}  // namespace biopsy::sim
