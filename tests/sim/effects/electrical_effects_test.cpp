// Effects on the voltage, each against its closed form or against a slow Euler integration of its equation.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

TEST(VoltageSaturation, IsLinearThenBentThenFlatAndOddInTheVoltage) {
  const VoltageSaturation limit{.level = 4000.0, .knee = 500.0};
  EXPECT_EQ(limit.limited(3500.0), 3500.0);
  EXPECT_DOUBLE_EQ(limit.limited(4000.0), 4000.0 - 125.0);  // level - knee/4
  EXPECT_EQ(limit.limited(4500.0), 4000.0);
  EXPECT_EQ(limit.limited(1e6), 4000.0);
  for (double u = 0.0; u < 6000.0; u += 10.0) {
    EXPECT_EQ(limit.limited(-u), -limit.limited(u));
    const double slope = (limit.limited(u + 10.0) - limit.limited(u)) / 10.0;
    EXPECT_GE(slope, 0.0);
    EXPECT_LE(slope, 1.0 + 1e-12);
  }
  EXPECT_EQ((VoltageSaturation{.level = 4000.0, .knee = 0.0}.limited(3999.0)), 3999.0);
}

TEST(VoltageSaturation, MakesEveryVoltageAboveItTheSameVoltage) {
  PlantModel model;
  model.effects.voltage_saturation = VoltageSaturation{.level = 3000.0, .knee = 200.0};
  const PlantState a = charged(model, at_rest(model), 3300.0, 500),
                   b = charged(model, at_rest(model), 6000.0, 500);
  EXPECT_EQ(a.motion.x, b.motion.x);
  EXPECT_EQ(b.u_i, 3000.0);
  EXPECT_EQ(a.motion.x, charged(PlantModel{}, at_rest(PlantModel{}), 3000.0, 500).motion.x);
}

TEST(AmplifierLag, ApproachesExponentially) {
  PlantModel model;
  model.effects.amplifier_lag = AmplifierLag{.time = 5e-3, .slew = 0.0};
  PlantState state = at_rest(model);
  for (int k = 1; k <= 50; ++k) {
    state = step(model, state, {.voltage = 3000.0}, Seconds(1e-3));
    ASSERT_NEAR(state.u_i, -3000.0 * std::expm1(-k / 5.0), 1e-8);
  }
}

TEST(AmplifierLag, LimitedSlopeGoesStraightAndArrives) {
  PlantModel model;
  model.effects.amplifier_lag = AmplifierLag{.time = 0.0, .slew = 2e-6};  // 2 ms a kilovolt
  PlantState state = at_rest(model);
  for (int k = 1; k <= 10; ++k) {
    state = step(model, state, {.voltage = -3000.0}, Seconds(1e-3));
    ASSERT_NEAR(state.u_i, -std::min(500.0 * k, 3000.0), 1e-8);
  }
}

// Euler at 0.1 us of every electrical equation at once.
struct Slow {
  double u_i = 0.0, u_o = 0.0, s = 0.0;
  void advance(const PlantModel& m, double command, double t) {
    constexpr double h = 1e-7;
    const AmplifierLag& lag = *m.effects.amplifier_lag;
    const ChargeRetention& charge = *m.effects.charge_retention;
    for (int i = 0; i < static_cast<int>(std::lround(t / h)); ++i) {
      const double slope = std::clamp((command - u_i) / lag.time, -1.0 / lag.slew, 1.0 / lag.slew);
      const double du = slope * h, old = u_o;
      u_i += du;
      u_o += m.baseline.K * du - u_o / m.baseline.tau * h;
      s += (charge.share * old - s) / charge.time * h;
    }
  }
};

TEST(AmplifierLagWithChargeRetention, FollowTheirEquationsThroughSlopeApproachAndReversal) {
  PlantModel model;
  model.baseline.tau = 0.05;
  model.effects.amplifier_lag = AmplifierLag{.time = 2e-3, .slew = 1e-6};
  model.effects.charge_retention = ChargeRetention{.share = 0.4, .time = 0.03};
  PlantState state = at_rest(model);
  Slow slow;
  for (int k = 0; k < 60; ++k) {
    const double command = k < 30 ? 3000.0 : -3000.0;
    state = step(model, state, {.voltage = command}, Seconds(1e-3));
    slow.advance(model, command, 1e-3);
    ASSERT_NEAR(state.u_i, slow.u_i, 0.5) << k;
    ASSERT_NEAR(state.u_o, slow.u_o, 0.5) << k;
    ASSERT_NEAR(state.screened, slow.s, 0.5) << k;
  }
}

TEST(AmplifierLag, PutsOutTheChargeThatItsCurrentAddsUpTo) {
  PlantModel model;
  model.effects.amplifier_lag = AmplifierLag{.time = 3e-3, .slew = 1e-6};
  PlantState state = at_rest(model);
  double sum = 0.0, integral = 0.0;
  for (int k = 0; k < 4000; ++k) {
    const double before = current(model, state);
    state = step(model, state, {.voltage = 2500.0}, Seconds(1e-5));
    sum += state.charge;
    if (k > 0)
      integral += 0.5e-5 * (before + current(model, state));
    else
      integral += 1e-5 * current(model, state);
  }
  EXPECT_NEAR(sum, model.baseline.C1 * (state.u_i - state.u_o), 1e-9 * sum);
  EXPECT_NEAR(integral, sum, 2e-3 * sum);
}

TEST(AmplifierLag, WithTheStacksOwnTimeConstantStaysFinite) {
  PlantModel model;
  model.baseline.tau = 0.01;
  model.effects.amplifier_lag = AmplifierLag{.time = 0.01, .slew = 0.0};
  model.effects.charge_retention = ChargeRetention{.share = 0.5, .time = 0.01};
  const PlantState state = charged(model, at_rest(model), 1000.0, 10);
  EXPECT_NEAR(state.u_o, 0.8 * 1000.0 * 1.0 * std::exp(-1.0), 1e-2);             // K U (t/T) exp(-t/T)
  EXPECT_NEAR(state.screened, 0.5 * 0.8 * 1000.0 * 0.5 * std::exp(-1.0), 1e-2);  // (t/T)^2/2
}

TEST(ChargeRetention, ScreensItsShareOfAHeldVoltageInTheEnd) {
  PlantModel model;
  model.baseline.tau = 1e6;
  model.effects.charge_retention = ChargeRetention{.share = 0.3, .time = 2.0};
  PlantState state = charged(model, at_rest(model), 2500.0, 1000);
  EXPECT_NEAR(state.screened, 0.3 * 2000.0 * -std::expm1(-0.5), 0.01);
  state = charged(model, state, 2500.0, 40000);
  EXPECT_NEAR(state.screened / state.u_o, 0.3, 1e-6);
  PlantModel weaker;  // in the end as if only 70 % were there
  weaker.baseline.tau = 1e6;
  EXPECT_NEAR(state.motion.x, charged(weaker, at_rest(weaker), 0.7 * 2500.0, 5000).motion.x, 2e-6);
  const PlantState turned = step(model, state, {.voltage = -2500.0}, Seconds(1e-3));
  EXPECT_NEAR(turned.u_o - turned.screened, -1.3 * 2000.0, 5.0);  // and a reversal pulls more
}

TEST(PolarityAsymmetry, ScalesEitherPolarityTheOtherWay) {
  PlantModel model, plain;
  model.baseline.tau = plain.baseline.tau = 1e6;
  model.effects.polarity_asymmetry = PolarityAsymmetry{0.1};
  for (const double sign : {1.0, -1.0})
    EXPECT_NEAR(charged(model, at_rest(model), sign * 2000.0, 3000).motion.x,
                charged(plain, at_rest(plain), (1.0 + 0.1 * sign) * 2000.0, 3000).motion.x, 1e-9);
}

TEST(PolarityAsymmetry, RipplesAtTheFrequencyOfTheReversals) {
  PlantModel model;
  model.baseline.tau = 1e6;
  model.effects.polarity_asymmetry = PolarityAsymmetry{0.05};
  PlantState state = at_rest(model);
  double first = 0.0, second = 0.0;  // Fourier sums at the reversals' 1 Hz and its double
  for (int k = 0; k < 10000; ++k) {
    state = step(model, state, {.voltage = (k / 500) % 2 == 0 ? 2500.0 : -2500.0}, Seconds(1e-3));
    if (k < 5000) continue;
    const double angle = 2 * std::numbers::pi * k * 1e-3;
    first += state.motion.x * std::sin(angle) / 2500.0;
    second += state.motion.x * std::sin(2 * angle) / 2500.0;
  }
  EXPECT_GT(std::abs(first), 0.1e-3);
  EXPECT_GT(std::abs(first), 5 * std::abs(second));
}

// Beside the charge between C1 and C2, integrated by itself: dQ/dt = u_o/R, u_o = (C1 u_i - Q)/(C1 + C2).
TEST(ZippingCapacitance, KeepsTheChargeThatLeakageLeaves) {
  for (const double lag : {0.0, 5e-3}) {
    PlantModel model = with_effect(PlantModel{}, ZippingCapacitance{1000.0});
    if (lag > 0.0) model.effects.amplifier_lag = AmplifierLag{.time = lag, .slew = 0.0};
    model.baseline.tau = 0.8;
    const Baseline& b = model.baseline;
    const double flat = b.C1 / b.K, R = b.tau / flat;  // C1 + C2 of flat pouches, F; Ohm
    PlantState state = at_rest(model);
    double leaked = 0.0, moved = 0.0, ratio = 1.0, most = 1.0;
    for (int k = 0; k < 12000; ++k) {
      const PlantState before = state;
      state = step(model, state, {.voltage = ramps_and_flips(k)}, Seconds(1e-3));
      const double jump = lag > 0.0 ? 0.0 : b.K / ratio * (state.u_i - before.u_i);
      leaked += 1e-3 * 0.5 * (before.u_o + jump + state.u_o) / R;
      moved += state.charge;
      ratio = 1.0 + 1000.0 * (state.motion.H - b.H_0);
      most = std::max(most, ratio);
      ASSERT_NEAR(state.u_o, (b.C1 * state.u_i - leaked) / (flat * ratio), 2.0) << lag << " s, " << k;
    }
    EXPECT_GT(most, 1.1);  // it did grow
    EXPECT_NEAR(moved, b.C1 * (state.u_i - state.u_o), 1e-9 * std::abs(moved) + 1e-15);
  }
}

TEST(ZippingCapacitance, KeepsTheChargeWherePlateAIsPut) {
  const PlantModel model = with_effect(PlantModel{}, ZippingCapacitance{1000.0});
  PlantState state = charged(model, at_rest(model), 3000.0, 300);
  const auto charge = [&] { return state.u_o * (1.0 + 1000.0 * (state.motion.H - model.baseline.H_0)); };
  const double before = charge(), H = state.motion.H;
  set_state(model, state, state.motion.x - 1e-3, 0.0);
  EXPECT_LT(state.motion.H, H);
  EXPECT_NEAR(charge(), before, 1e-9 * before);
}

TEST(ZippingCapacitance, LowersTheStackUnderTheSameVoltage) {
  const PlantModel plain, grown = with_effect(PlantModel{}, ZippingCapacitance{300.0});
  const double x = charged(plain, at_rest(plain), 3000.0, 500).motion.x;
  const double lower = charged(grown, at_rest(grown), 3000.0, 500).motion.x;
  EXPECT_LT(lower, 0.97 * x);
  EXPECT_GT(lower, 0.5 * x);
}

}  // namespace
}  // namespace biopsy::sim
