// Where a mass under a constant force ends with one effect, by hand arithmetic.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

struct SteadyState {
  const char* name;
  PlantModel model;
  double start, force;  // m, N
  int milliseconds;
  double Motion::*member;
  double expected, within;
};

std::vector<SteadyState> steady_states() {
  constexpr auto x = &Motion::x, v = &Motion::v;
  const auto drag = with_effect(bare_mass(), QuadraticDamping{100.0});
  const auto yielding = with_effect(bare_mass(3.0), HystereticSpring{.stiffness = 200.0, .yield = 0.5e-3});
  const auto dry = with_effect(bare_mass(), CoulombFriction{0.1});
  const StribeckFriction sticky{.sliding = 0.1, .breakaway = 0.2, .speed = 1e-3};
  const LayerPuncture skin{
      .depth = 1e-3, .force = 0.4, .deflection = 1e-3, .collapse = 0.2e-3, .cutting = 0.1};
  const ShaftFriction viscous{.from = 0.0, .to = 1e-3, .viscous = 2000.0};  // 2 N s/m at 1 mm
  return {
      {"quadratic damping: sqrt(F/c)", drag, 0.0, 0.04, 4000, v, 0.02, 1e-9},
      {"the same down", drag, 0.0, -0.04, 4000, v, -0.02, 1e-9},
      {"hysteretic spring, 1 % of its force: F/k", yielding, 0.0, 0.001, 10000, x, 5e-6, 1e-8},
      {"hysteretic spring, yielding", yielding, 0.0, 0.4, 3000, v, (0.4 - 0.1) / 3.0, 1e-9},
      {"external force", with_effect(bare_mass(5.0, 140.0), ExternalForce{0.2}), 0.0, 0.5, 5000, x,
       0.3 / 140.0, 1e-12},
      {"Coulomb friction: v = (F - friction) t/m", dry, 0.0, 0.15, 400, v, 0.05 / 0.080 * 0.4, 1e-12},
      {"the same down", dry, 0.0, -0.15, 400, x, -0.5 * 0.05 / 0.080 * 0.16, 1e-12},
      {"Coulomb friction with damping", with_effect(bare_mass(2.0), CoulombFriction{0.1}), 0.0, 0.3, 3000, v,
       0.1, 1e-9},
      {"Stribeck friction below breakaway", with_effect(bare_mass(), sticky), 0.0, 0.199, 3000, x, 0.0, 0.0},
      {"Stribeck friction with damping", with_effect(bare_mass(2.0), sticky), 0.0, 0.3, 3000, v, 0.1, 1e-9},
      {"puncture, below its force", with_effect(bare_mass(3.0), skin), 1e-3, 0.1, 20000, x, 1.5e-3, 1e-8},
      {"shaft friction, viscous", with_effect(bare_mass(), viscous), 1e-3, 0.1, 2000, v, 0.1 / 2.0, 1e-9}};
}

TEST(Effects, SteadyStatesUnderAConstantForceAreThoseOfHandArithmetic) {
  for (const SteadyState& c : steady_states()) {
    PlantState state = at_rest(c.model);
    state.motion.x = state.x_max = c.start;
    EXPECT_NEAR(pushed(c.model, state, c.force, c.milliseconds).motion.*c.member, c.expected, c.within)
        << c.name;
  }
}

}  // namespace
}  // namespace biopsy::sim
