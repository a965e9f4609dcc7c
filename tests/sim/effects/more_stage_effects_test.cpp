// Springs, drag, stop, masses and pushes on plate A, each alone on a mass that a force drives.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

TEST(QuadraticDamping, SlowsACoastingMassHyperbolically) {
  const PlantModel model = with_effect(bare_mass(), QuadraticDamping{100.0});
  PlantState coasting = at_rest(model);
  coasting.motion.v = 0.05;  // 1/v = 1/v0 + c t/m
  EXPECT_NEAR(pushed(model, coasting, 0.0, 500).motion.v, 1.0 / (1.0 / 0.05 + 100.0 * 0.5 / 0.080), 1e-7);
}

TEST(SpringHardening, BalancesForceByTheCubicSpring) {
  const PlantModel model = with_effect(bare_mass(5.0, 140.0), SpringHardening{1e9});
  const double x = pushed(model, at_rest(model), 0.5, 10000).motion.x;
  EXPECT_NEAR(140.0 * x + 1e9 * x * x * x, 0.5, 1e-9);
}

TEST(SpringHardening, OfTheStackActsOnTheStretchBetweenThePlates) {
  PlantModel model;
  model.baseline.tau = 1e12;
  model.effects.spring_hardening = SpringHardening{1e9};
  PlantState state = at_rest(model);
  for (int k = 0; k < 10000; ++k)
    state = step(model, state, {.voltage = 3000.0, .external_force = 0.2}, Seconds(1e-3));
  const double stretch = plate_b(model, state) - state.motion.x;
  EXPECT_NEAR(140.0 * stretch + 1e9 * stretch * stretch * stretch, 0.2, 1e-6);
}

TEST(HystereticSpring, IsBoundedAndEatsWorkInEveryCycle) {
  for (const double sharpness : {1.0, 2.0, 6.0})
    for (const double beta : {0.1, 0.5, 1.0}) {
      const HystereticSpring spring{100.0, 0.5e-3, sharpness, beta};
      double z = 0.0, area = 0.0;
      constexpr int kCycle = 20000;
      for (int i = 0; i < 3 * kCycle; ++i) {
        const double dx = 2e-3 * 2 * std::numbers::pi / kCycle * std::cos(2 * std::numbers::pi * i / kCycle);
        const double before = z;
        z += spring.rate(dx, z);
        ASSERT_LE(std::abs(z), 0.5e-3 * (1 + 1e-6));
        if (i >= 2 * kCycle) area += spring.pull(0.5 * (before + z)) * dx;
      }
      EXPECT_GT(area, 0.0) << sharpness << " " << beta;
      EXPECT_LT(area, 4 * 100.0 * 0.5e-3 * 2e-3) << sharpness << " " << beta;  // the box around the loop
    }
}

TEST(HystereticSpring, YieldsAtItsYieldDisplacement) {
  const PlantModel model = with_effect(bare_mass(3.0), HystereticSpring{.stiffness = 200.0, .yield = 0.5e-3});
  const PlantState sliding = pushed(model, at_rest(model), 0.4, 3000);
  EXPECT_NEAR(state_of<HystereticSpring>(sliding), 0.5e-3, 1e-9);
}

// dz/dx = 1 + |z|/yield on loading (n = 1, stiffening 1), whose solution is an exponential.
TEST(HystereticSpring, StiffensAsItIsLoadedWhereTold) {
  const HystereticSpring spring{
      .stiffness = 100.0, .yield = 0.5e-3, .sharpness = 1.0, .beta = 0.5, .stiffening = 1.0};
  double z = 0.0;
  constexpr double kStep = 1e-9;  // Euler: 1.4 nm off after half a millimetre
  for (int i = 0; i < 500000; ++i) z += spring.rate(kStep, z);
  EXPECT_NEAR(z, 0.5e-3 * (std::exp(1.0) - 1.0), 1e-8);
  EXPECT_NEAR(spring.pull(z), 100.0 * z, 1e-12);
  EXPECT_GT(-spring.rate(-kStep, z), spring.rate(kStep, z));  // and unloads along a steeper way
}

TEST(HystereticSpring, StaysBoundedWhereItYieldsFasterThanTheStep) {
  const PlantModel model =
      with_effect(bare_mass(), HystereticSpring{.stiffness = 1e4, .yield = 1e-6, .sharpness = 6.0});
  PlantState state = at_rest(model);
  for (int k = 0; k < 2000; ++k) {
    state = step(model, state, {.force = (k / 200) % 2 == 0 ? 0.5 : -0.5}, Seconds(1e-3));
    ASSERT_LE(std::abs(state_of<HystereticSpring>(state)), 1e-6);
    ASSERT_LT(std::abs(state.motion.v), 2.0);
  }
}

TEST(EndStop, IsPenetratedByNoMoreThanForceOverStiffness) {
  const PlantModel model =
      with_effect(bare_mass(1.0), EndStop{.position = 1e-3, .stiffness = 20e3, .damping = 50.0});
  PlantState state = pushed(model, at_rest(model), 0.5, 5000);
  EXPECT_NEAR(state.motion.x, 1e-3 + 0.5 / 20e3, 1e-9);
  state = pushed(model, state, -0.5, 100);  // and it never holds back
  EXPECT_LT(state.motion.v, -0.9 * 0.5 * (1 - std::exp(-0.1 / 0.08)));
}

TEST(EndStop, ReturnsNoMoreEnergyThanArrived) {
  for (const double stiffness : {1e3, 20e3, 1e6})
    for (const double damping : {0.0, 2.0, 50.0}) {
      PlantModel model = bare_mass();
      model.effects.end_stop = EndStop{.position = 1e-3, .stiffness = stiffness, .damping = damping};
      PlantState state = at_rest(model);
      state.motion.v = 0.05;
      state = pushed(model, state, 0.0, 200);
      EXPECT_LT(state.motion.v, damping > 0.0 ? 0.0 : -0.98 * 0.05) << stiffness << " " << damping;
      EXPECT_GT(state.motion.v, -0.05 * 1.02) << stiffness << " " << damping;
    }
}

TEST(AddedMass, LengthensThePeriodOfAForceDrivenOscillator) {
  PlantModel model = with_effect(bare_mass(0.0, 140.0), AddedMass{0.040});
  EXPECT_DOUBLE_EQ(model.mass_A(), 0.120);
  const double period = 2 * std::numbers::pi * std::sqrt(0.120 / 140.0);
  PlantState state = at_rest(model);
  state.motion.x = 1e-3;
  for (int k = 0; k < 1000; ++k) state = step(model, state, {}, Seconds(period * 1e-3));
  EXPECT_NEAR(state.motion.x, 1e-3, 1e-9);
  model.effects.added_mass->mass = -5.0;
  EXPECT_GT(model.mass_A(), 0.0);
}

TEST(AddedMass, WeighsOnTheStackLikeAHeavierRun) {
  PlantModel added, heavier;
  added.effects.added_mass = AddedMass{0.020};
  heavier.weight += 0.020;
  PlantState a = at_rest(added), b = at_rest(heavier);
  for (int k = 0; k < 3000; ++k) {
    a = step(added, a, {.voltage = 3000.0}, Seconds(1e-3));
    b = step(heavier, b, {.voltage = 3000.0}, Seconds(1e-3));
    ASSERT_NEAR(a.motion.x, b.motion.x, 1e-12);
  }
}

TEST(PeriodicDisturbance, ShakesAnOscillatorByItsFrequencyResponse) {
  PlantModel model = bare_mass(2.0, 140.0);
  const double f = 4.0, w = 2 * std::numbers::pi * f;
  model.effects.periodic_disturbance = PeriodicDisturbance{0.05, 0.3e-3, f, 0.7};
  PlantState state = at_rest(model);
  double s = 0.0, c = 0.0, read_s = 0.0, read_c = 0.0;
  for (int k = 0; k < 5000; ++k) {
    if (k >= 4000) {  // four periods, settled
      s += state.motion.x * std::sin(w * k * 1e-3) / 500.0;
      c += state.motion.x * std::cos(w * k * 1e-3) / 500.0;
      const double moved = displacement_reading(model, state) - state.motion.x;
      read_s += moved * std::sin(w * k * 1e-3) / 500.0;
      read_c += moved * std::cos(w * k * 1e-3) / 500.0;
    }
    state = step(model, state, {}, Seconds(1e-3));
  }
  const double gain = 0.05 / std::hypot(140.0 - 0.080 * w * w, 2.0 * w);
  const double late = std::atan2(2.0 * w, 140.0 - 0.080 * w * w);
  EXPECT_NEAR(std::hypot(s, c), gain, 1e-4 * gain);
  EXPECT_NEAR(std::atan2(c, s), 0.7 - late, 1e-4);
  EXPECT_NEAR(std::hypot(read_s, read_c), 0.3e-3, 1e-9);
  EXPECT_NEAR(std::atan2(read_c, read_s), 0.7, 1e-6);
}

}  // namespace
}  // namespace biopsy::sim
