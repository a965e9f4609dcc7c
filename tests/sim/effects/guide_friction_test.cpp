// Friction that grows with the push, and friction of bristles, each by closed forms or beside an integration
// of its published equation with steps of a microsecond.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

TEST(LoadDependentFriction, TakesItsShareOfThePushInEitherDirection) {
  const PlantModel model = with_effect(bare_mass(), LoadDependentFriction{0.25});
  for (const double push : {0.4, -0.4, 1e-4}) {
    const PlantState state = pushed(model, at_rest(model), push, 100);
    EXPECT_NEAR(state.motion.v, 0.75 * push / 0.080 * 0.1, 1e-6 * std::abs(push)) << push;
  }
}

// Loaded slowly a spring stands at F (1 - share)/k; unloaded, at F (1 + share)/k, after it stood still.
TEST(LoadDependentFriction, WidensTheLoopInProportionToTheLoad) {
  constexpr double kShare = 0.1, kSpring = 140.0, kMost = 1.0;
  const PlantModel model = with_effect(bare_mass(20.0, kSpring), LoadDependentFriction{kShare});
  PlantState state = at_rest(model);
  double still = 0.0;
  for (int k = 0; k < 40000; ++k) {
    const double force = kMost * (1.0 - std::abs(k - 20000) / 20000.0);
    const double before = state.motion.x;
    state = pushed(model, state, force, 1);
    if (k == 10000) {
      EXPECT_NEAR(state.motion.x, force * (1 - kShare) / kSpring, 0.02 * force / kSpring);
    }
    if (k == 30000) {
      EXPECT_NEAR(state.motion.x, force * (1 + kShare) / kSpring, 0.02 * force / kSpring);
    }
    if (k > 20000 && state.motion.x == before) still = force;
  }
  EXPECT_NEAR(still, kMost * (1 - kShare) / (1 + kShare), 0.01);
}

// On a stage it is the spring that pushes, and it carries the weight.
TEST(LoadDependentFriction, HoldsAHeavyWeightAgainstAForceThatMovesALightOne) {
  const auto moved = [](double weight) {
    PlantModel model = with_effect(PlantModel{}, LoadDependentFriction{0.1});
    model.weight = weight;
    return held(model, at_rest(model), {.external_force = 0.05}, 1000).motion.x;
  };
  EXPECT_LT(moved(0.0), -50e-6);  // 0.03 N hold 0.3 N of plate A
  EXPECT_EQ(moved(0.100), 0.0);   // 0.13 N
}

TEST(LugreFriction, GivesWayElasticallyBelowItsBreakaway) {
  const PlantModel model = with_effect(
      bare_mass(10.0), LugreFriction{.sliding = 0.05, .breakaway = 0.08, .speed = 1e-3, .stiffness = 4e3});
  for (const double force : {0.004, -0.004}) {
    const PlantState state = pushed(model, at_rest(model), force, 400);
    EXPECT_NEAR(state.motion.x, force / 4e3, 0.1 * std::abs(force) / 4e3);
  }
}

TEST(LugreFriction, SlidesAtTheFrictionOfItsSpeed) {
  const LugreFriction friction{.sliding = 0.05, .breakaway = 0.09, .speed = 4e-3, .stiffness = 4e3};
  const PlantModel model = with_effect(bare_mass(20.0), friction);
  const PlantState state = pushed(model, at_rest(model), 0.25, 4000);
  EXPECT_NEAR(0.25, 20.0 * state.motion.v + friction.steady(state.motion.v), 1e-6);
}

// A mass on a soft spring whose far end is pulled: it sticks and slips.
TEST(LugreFriction, SticksAndSlipsAsItsEquationIntegratedInMicroseconds) {
  const LugreFriction friction{
      .sliding = 0.10, .breakaway = 0.20, .speed = 2e-3, .stiffness = 5e3, .damping = 0.5e-3};
  constexpr double kSpring = 100.0, kDamping = 0.4, kPull = 2e-3, kMass = 0.080;
  PlantModel model = with_effect(bare_mass(kDamping, kSpring), friction);
  model.internal_step = 0.1e-3;
  PlantState state = at_rest(model);
  double x = 0.0, v = 0.0, z = 0.0, worst = 0.0, fastest = 0.0;
  for (int ms = 0; ms < 3000; ++ms) {
    const double force = kSpring * kPull * ms * 1e-3;
    state = pushed(model, state, force, 1);
    for (int i = 0; i < 1000; ++i) {
      const double ratio = v / friction.speed;
      const double g = 0.10 + 0.10 * std::exp(-ratio * ratio);
      const double bending = v - 5e3 * std::abs(v) / g * z;
      z += 1e-6 * bending;
      v += 1e-6 * (force - kSpring * x - kDamping * v - 5e3 * z - 2.5 * bending) / kMass;
      x += 1e-6 * v;
    }
    worst = std::max(worst, std::abs(state.motion.x - x));
    fastest = std::max(fastest, v);
  }
  EXPECT_GT(fastest, 3.0 * kPull);  // it did slip
  EXPECT_LT(worst, 20e-6);
}

TEST(LugreFriction, StaysBoundedWithBristlesFarStifferThanAStepResolves) {
  const LugreFriction friction{.sliding = 0.05, .breakaway = 0.06, .speed = 1e-3, .stiffness = 1e7};
  const PlantModel model = with_effect(bare_mass(), friction);
  PlantState state = at_rest(model);
  for (int k = 0; k < 2000; ++k) {
    state = pushed(model, state, k % 400 < 200 ? 0.5 : -0.5, 1);
    ASSERT_LE(std::abs(state_of<LugreFriction>(state).bend), 0.06 / 1e7 * (1 + 1e-12));
    ASSERT_LT(std::abs(state.motion.v), 2.0);
  }
}

}  // namespace
}  // namespace biopsy::sim
