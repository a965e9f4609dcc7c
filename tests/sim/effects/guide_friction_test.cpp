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

// The published equation in steps of a microsecond: x of a mass on a spring after each millisecond of
// force(s).
template <class Force>
double worst_beside_microseconds(const LugreFriction& friction, double spring, double damping,
                                 int milliseconds, const Force& force) {
  constexpr double h = 1e-6, kMass = 0.080;
  PlantModel model = with_effect(bare_mass(damping, spring), friction);
  model.internal_step = 0.1e-3;
  PlantState state = at_rest(model);
  double x = 0.0, v = 0.0, z = 0.0, worst = 0.0;
  for (int ms = 0; ms < milliseconds; ++ms) {
    state = pushed(model, state, force(1e-3 * ms), 1);
    for (int i = 0; i < 1000; ++i) {
      const double fading = std::exp(-std::pow(v / friction.speed, 2));
      const double g = friction.sliding + (friction.breakaway - friction.sliding) * fading;
      const double bending = v - friction.stiffness * std::abs(v) / g * z;
      z += h * bending;
      v += h *
           (force(1e-3 * ms) - spring * x - damping * v -
            friction.stiffness * (z + friction.damping * fading * bending)) /
           kMass;
      x += h * v;
    }
    worst = std::max(worst, std::abs(state.motion.x - x));
  }
  return worst;
}

// A spring whose far end is pulled: the mass sticks and slips.
TEST(LugreFriction, SticksAndSlipsAsItsEquationIntegratedInMicroseconds) {
  const LugreFriction friction{
      .sliding = 0.10, .breakaway = 0.20, .speed = 2e-3, .stiffness = 5e3, .damping = 0.5e-3};
  EXPECT_LT(worst_beside_microseconds(friction, 100.0, 0.4, 3000, [](double t) { return 0.2 * t; }), 20e-6);
}

TEST(LugreFriction, MayVanishWithSpeed) {
  const LugreFriction friction{
      .sliding = 1e-4, .breakaway = 0.08, .speed = 1e-3, .stiffness = 300.0, .damping = 1e-3};
  const auto sine = [](double t) { return 0.3 * std::sin(6.0 * t); };
  EXPECT_LT(worst_beside_microseconds(friction, 140.0, 0.6, 3000, sine), 60e-6);
  PlantModel model = with_effect(bare_mass(0.6, 140.0),
                                 LugreFriction{.breakaway = 0.05, .stiffness = 300.0, .damping = 1e-3});
  PlantState state = at_rest(model);
  for (int ms = 0; ms < 3000; ++ms) {
    state = pushed(model, state, sine(1e-3 * ms), 1);
    ASSERT_LT(std::abs(state.motion.x), 20e-3);
  }
}

// Nearly: plate A is held for up to two steps longer.
TEST(LugreFriction, OfStiffBristlesIsCoulombFriction) {
  const PlantModel dry = with_effect(bare_mass(2.0, 140.0), CoulombFriction{0.05});
  for (const double stiffness : {3e5, 1e6})
    for (const double damping : {0.0, 1e-3, 3e-3}) {
      const PlantModel model = with_effect(
          bare_mass(2.0, 140.0),
          LugreFriction{
              .sliding = 0.05, .breakaway = 0.05, .speed = 1e-3, .stiffness = stiffness, .damping = damping});
      PlantState bristles = at_rest(model), plain = at_rest(dry);
      for (int k = 0; k < 4000; ++k) {
        const double force = k % 800 < 400 ? 0.5 : -0.2;
        bristles = pushed(model, bristles, force, 1);
        plain = pushed(dry, plain, force, 1);
        ASSERT_NEAR(bristles.motion.x, plain.motion.x, 0.2e-3) << stiffness << ", " << damping << ", " << k;
      }
    }
}

// Where even the shortest cut of a step (1/64) does not resolve them, they are no more exact.
TEST(LugreFriction, StaysBoundedWithBristlesThatNoCutOfAStepResolves) {
  for (const double damping : {0.0, 1e-3, 10e-3}) {
    const PlantModel model = with_effect(
        bare_mass(2.0, 140.0),
        LugreFriction{
            .sliding = 0.05, .breakaway = 0.05, .speed = 1e-3, .stiffness = 1e7, .damping = damping});
    PlantState state = at_rest(model);
    for (int k = 0; k < 4000; ++k) {
      state = pushed(model, state, k % 800 < 400 ? 0.5 : -0.2, 1);
      ASSERT_LT(std::abs(state.motion.x), 2.0 * 0.5 / 140.0) << damping << ", " << k;  // a ringing spring's
    }
  }
}

TEST(LugreFriction, MovesWithTheOrigin) {
  const PlantModel model =
      with_effect(bare_mass(0.6, 0.0), LugreFriction{.sliding = 0.05, .breakaway = 0.08, .stiffness = 500.0});
  PlantState here = pushed(model, at_rest(model), 0.06, 30), there = here;
  shift(model, there, 5e-3);
  for (const double force : {0.1, -0.1}) {
    here = pushed(model, here, force, 50);
    there = pushed(model, there, force, 50);
    EXPECT_NEAR(there.motion.x - here.motion.x, 5e-3, 1e-12);
  }
}

}  // namespace
}  // namespace biopsy::sim
