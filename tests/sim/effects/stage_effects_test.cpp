// Friction of the guide and hysteresis of the pouches, each by the physics that defines it.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

PlantModel rubbing(double friction, double damping = 0.0, double spring = 0.0) {
  const PlantModel model = with_effect(bare_mass(damping, spring), CoulombFriction{friction});
  return model;
}

TEST(CoulombFriction, HoldsAnyForceBelowItselfWithoutAMicron) {
  const PlantModel model = rubbing(0.1);
  for (const double force : {0.0999, -0.0999, 0.0}) {
    const PlantState state = pushed(model, at_rest(model), force, 5000);
    EXPECT_EQ(state.motion.x, 0.0) << force;
    EXPECT_EQ(state.motion.v, 0.0) << force;
  }
}

TEST(CoulombFriction, BringsAMovingMassToRestAfterItsKineticEnergyIsSpentAndKeepsItThere) {
  const PlantModel model = rubbing(0.1);
  PlantState state = at_rest(model);
  state.motion.v = 0.05;
  state = pushed(model, state, 0.0, 100);  // stops after m v / F = 40 ms
  EXPECT_EQ(state.motion.v, 0.0);
  EXPECT_NEAR(state.motion.x, 0.5 * 0.080 * 0.05 * 0.05 / 0.1, 1e-9);
  EXPECT_EQ(pushed(model, state, 0.09, 1000).motion.x, state.motion.x);
}

TEST(CoulombFriction, DissipatesFourTimesForceTimesAmplitudeInACycle) {
  const PlantModel model = rubbing(0.1, 1.0, 140.0);
  PlantState state = at_rest(model);
  double work = 0.0, viscous = 0.0, low = 1.0, high = -1.0;
  constexpr int kCycle = 4000, kCut = 4;
  const double h = 1e-3 / kCut;
  for (int k = 0; k < 3 * kCycle * kCut; ++k) {
    const double phase = static_cast<double>(k % (kCycle * kCut)) / (kCycle * kCut);
    const double force = 1.0 * (phase < 0.25 ? 4 * phase : phase < 0.75 ? 2 - 4 * phase : 4 * phase - 4);
    const PlantState before = state;
    state = step(model, state, {.force = force}, Seconds(h));
    if (k < 2 * kCycle * kCut) continue;  // a closed cycle only after the first
    work += force * (state.motion.x - before.motion.x);
    viscous += 0.5 * h * (before.motion.v * before.motion.v + state.motion.v * state.motion.v);
    low = std::min(low, state.motion.x);
    high = std::max(high, state.motion.x);
  }
  EXPECT_NEAR((high - low) / 2, 0.9 / 140.0, 0.02 * 0.9 / 140.0);
  EXPECT_NEAR(work - viscous, 4 * 0.1 * (high - low) / 2, 0.005 * work);
}

TEST(CoulombFriction, AnOscillationDecaysByTwiceTheDeadBandEachHalfCycle) {
  const PlantModel model = rubbing(0.07, 0.0, 140.0);  // dead band F/k = 0.5 mm
  PlantState state = at_rest(model);
  state.motion.x = 0.0046;
  std::vector<double> turns;
  for (int k = 0; k < 1000; ++k) {
    const PlantState before = state;
    state = step(model, state, {}, Seconds(1e-3));
    const bool stopped = state.motion.v == 0.0 && before.motion.v != 0.0;
    if (before.motion.v * state.motion.v < 0.0 || stopped) turns.push_back(before.motion.x);
  }
  // 4.6 -> -3.6 -> 2.6 -> -1.6 -> 0.6 -> 0.4, which is inside the dead band.
  ASSERT_EQ(turns.size(), 5U);
  const double expected_mm[] = {-3.6, 2.6, -1.6, 0.6, 0.4};
  for (int n = 0; n < 5; ++n) EXPECT_NEAR(turns[n], expected_mm[n] * 1e-3, 5e-6) << n;
  EXPECT_EQ(state.motion.v, 0.0);
}

PlantModel sticky(double damping = 0.0) {
  const PlantModel model =
      with_effect(bare_mass(damping), StribeckFriction{.sliding = 0.1, .breakaway = 0.2, .speed = 1e-3});
  return model;
}

TEST(StribeckFriction, NeedsBreakawayFromRestButOnlySlidingFrictionInMotion) {
  const PlantModel model = sticky();
  EXPECT_GT(pushed(model, at_rest(model), 0.201, 3000).motion.x, 0.0);
  PlantState moving = at_rest(model);
  moving.motion.v = 0.02;  // twenty times the Stribeck speed: 0.15 N carry it on, which never started it
  EXPECT_NEAR(pushed(model, moving, 0.15, 500).motion.v, 0.02 + 0.05 / 0.080 * 0.5, 1e-9);
}

TEST(StribeckFriction, FallsFromBreakawayToSlidingOverItsSpeed) {
  const StribeckFriction friction{.sliding = 0.1, .breakaway = 0.2, .speed = 1e-3};
  EXPECT_EQ(friction.magnitude(0.0), 0.2);
  EXPECT_DOUBLE_EQ(friction.magnitude(1e-3), 0.1 + 0.1 * std::exp(-1.0));
  EXPECT_EQ(friction.magnitude(-1e-3), friction.magnitude(1e-3));
  EXPECT_NEAR(friction.magnitude(5e-3), 0.1, 1e-11);
}

TEST(StribeckFriction, PulledSlowlyThroughASpringMovesInJerks) {
  PlantModel model = sticky(0.2);
  model.baseline.k = 140.0;
  PlantState state = at_rest(model);
  int starts = 0, resting = 0;
  for (int k = 0; k < 10000; ++k) {
    const bool still = state.motion.v == 0.0;
    state = step(model, state, {.force = 0.14 * k * 1e-3}, Seconds(1e-3));  // 1 mm/s of spring
    starts += still && state.motion.v != 0.0;
    resting += still;
  }
  EXPECT_GT(starts, 5);
  EXPECT_GT(resting, 2000);
  PlantModel smooth = model;
  smooth.effects.stribeck_friction.reset();
  smooth.effects.coulomb_friction = CoulombFriction{0.1};  // without the excess it slides on
  PlantState slides = at_rest(smooth);
  int smooth_starts = 0;
  for (int k = 0; k < 10000; ++k) {
    const bool still = slides.motion.v == 0.0;
    slides = step(smooth, slides, {.force = 0.14 * k * 1e-3}, Seconds(1e-3));
    smooth_starts += still && slides.motion.v != 0.0;
  }
  EXPECT_LT(smooth_starts, starts);
}

// The play operator alone
// ------------------------------------------------------------------------------------------
double swept(const ZippingHysteresis& play, double zipped, double from, double to) {
  for (int i = 1; i <= 1000; ++i) zipped = play.zipped(from + (to - from) * i / 1000, zipped);
  return zipped;
}

TEST(ZippingHysteresis, RisesHalfAWidthLateAndFallsHalfAWidthLate) {
  const ZippingHysteresis play{.width = 0.1e-3};
  EXPECT_DOUBLE_EQ(swept(play, 0.0, 0.0, 1e-3), 0.95e-3);
  EXPECT_DOUBLE_EQ(swept(play, 0.95e-3, 1e-3, 0.5e-3), 0.55e-3);
  EXPECT_DOUBLE_EQ(swept(play, 0.95e-3, 1e-3, 0.901e-3), 0.95e-3);  // inside the play nothing moves
}

TEST(ZippingHysteresis, AMinorLoopClosesAndIsForgotten) {
  const ZippingHysteresis play{.width = 0.1e-3};
  const double turned = swept(play, 0.0, 0.0, 1.0e-3);
  const double back = swept(play, swept(play, turned, 1.0e-3, 0.7e-3), 0.7e-3, 1.0e-3);
  EXPECT_DOUBLE_EQ(back, turned);  // return-point memory
  EXPECT_DOUBLE_EQ(swept(play, back, 1.0e-3, 1.5e-3), swept(play, turned, 1.0e-3, 1.5e-3));  // wiped out
}

TEST(ZippingHysteresis, OpensTheVoltageLoopOfTheStackByItsWidthTimesThePouches) {
  PlantModel model;
  model.baseline.tau = 1e15;
  model.effects.zipping_hysteresis = ZippingHysteresis{.width = 0.05e-3};
  PlantState state = at_rest(model);
  const auto ramp_to = [&](double volts) {
    const double from = state.u_i;
    for (int k = 1; k <= 40000; ++k)  // slow: ringing would ratchet the play
      state = step(model, state, {.voltage = from + (volts - from) * k / 40000}, Seconds(1e-3));
    for (int k = 0; k < 3000; ++k) state = step(model, state, {.voltage = volts}, Seconds(1e-3));
    return state.motion.x;
  };
  const double up = ramp_to(2500.0);
  ramp_to(4000.0);
  const double down = ramp_to(2500.0);
  EXPECT_NEAR(down - up, 11 * 0.05e-3, 0.02 * 11 * 0.05e-3);
  ramp_to(1500.0);
  EXPECT_NEAR(ramp_to(2500.0), up, 0.02 * 11 * 0.05e-3);  // the loop closes
}

}  // namespace
}  // namespace biopsy::sim
