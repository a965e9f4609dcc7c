// The baseline against a second implementation, hand arithmetic and invariants of the paper's equations.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "sim/plant/plant.hpp"
#include "sim/plant/pouch.hpp"
#include "tests/sim/plant/reference_plant.hpp"

namespace biopsy::sim {
namespace {

using Drive_V = std::function<double(double time)>;

double flipping(double time, double frequency_Hz) {
  return static_cast<long>(std::floor(2.0 * frequency_Hz * time + 1e-9)) % 2 == 0 ? 1.0 : -1.0;
}

struct Scenario {
  std::string name;
  Drive_V voltage;
  std::function<double(double)> push = [](double) { return 0.0; };
};

std::vector<Scenario> scenarios() {
  return {
      {"DC", [](double) { return 3000.0; }},
      {"AC02", [](double t) { return 3000.0 * flipping(t, 0.2); }},
      {"AC2", [](double t) { return 4000.0 * flipping(t, 2.0); }},
      {"AC10", [](double t) { return 6000.0 * flipping(t, 10.0); }},
      {"Ramps",
       [](double t) { return (t < 1.5 ? 4000.0 * t / 1.5 : 4000.0 * (3.0 - t) / 1.5) * flipping(t, 2.0); }},
      {"Pushed", [](double t) { return 3000.0 * flipping(t, 2.0); },
       [](double t) { return t < 0.8   ? 0.0
                             : t < 1.5 ? 0.4
                                       : -0.2; }}};
}

class AgainstReference : public testing::TestWithParam<double> {};

TEST_P(AgainstReference, DisplacementAgreesToAMicrometreRms) {
  constexpr int kSamples = 3000;
  for (const Scenario& scenario : scenarios()) {
    std::vector<ReferenceInput> inputs;
    for (int k = 0; k < kSamples; ++k)
      inputs.push_back({scenario.voltage(k * 1e-3), scenario.push(k * 1e-3)});
    const auto expected = reference_run(inputs, GetParam() * 1e-3, 10e-6);
    PlantModel model;
    model.weight = GetParam() * 1e-3;
    PlantState state = at_rest(model);
    double squares = 0.0, farthest = 0.0, worst = 0.0;
    for (int k = 0; k < kSamples; ++k) {
      state = step(model, state, {.voltage = inputs[k].voltage, .external_force = inputs[k].external_force},
                   Seconds(1e-3));
      const double error_mm = (state.motion.x - expected[k].plate_a) * 1e3;
      squares += error_mm * error_mm;
      worst = std::max(worst, std::abs(error_mm));
      farthest = std::max(farthest, std::abs(expected[k].plate_a));
      ASSERT_NEAR(state.u_o, expected[k].u_o, 1e-6) << scenario.name;
      ASSERT_NEAR(plate_b(model, state), expected[k].plate_b, 5e-6) << scenario.name << " at sample " << k;
    }
    EXPECT_GT(farthest, 0.5e-3) << scenario.name << ": moved too little to compare anything";
    EXPECT_LE(std::sqrt(squares / kSamples), 1e-3) << scenario.name << ", worst " << worst << " mm";
  }
}

INSTANTIATE_TEST_SUITE_P(Grams, AgainstReference, testing::Values(0.0, 20.0, 50.0, 100.0, 260.0),
                         [](const auto& given) {
                           return "Weight" + std::to_string(static_cast<int>(given.param));
                         });

TEST(Reference, HalvingItsOwnStepMovesItLessThanATenthOfAMicrometre) {
  std::vector<ReferenceInput> inputs;
  for (int k = 0; k < 1000; ++k) inputs.push_back({4000.0 * flipping(k * 1e-3, 2.0), 0.0});
  const auto coarse = reference_run(inputs, 0.05, 10e-6), fine = reference_run(inputs, 0.05, 5e-6);
  for (std::size_t k = 0; k < inputs.size(); ++k) ASSERT_NEAR(coarse[k].plate_a, fine[k].plate_a, 1e-7) << k;
}

// A stack whose charge does not leak, so that it comes to rest.
PlantModel tight(double weight) {
  PlantModel model;
  model.baseline.tau = 1e15;
  model.weight = weight;
  return model;
}

PlantState settled(const PlantModel& model, const PlantInputs& inputs) {
  PlantState state = at_rest(model);
  for (int k = 0; k < 20000; ++k) state = step(model, state, inputs, Seconds(1e-3));
  return state;
}

TEST(Equilibrium, FiftyGramsAtThreeKilovoltsRestAsByHandArithmetic) {
  // u_o = 0.8 x 3000 V = 2400 V; P = 3.4 x 8.8541878128e-12 x 2400^2 / (2 x 1e-8) = 8669.94 Pa.
  // F = (0.080 + 0.030) 9.81 = 1.0791 N; S = 1.0791 / (0.060 x 8669.94) = 2.07440 mm.
  // sqrt(S^2 + pi 1.9e-7 / 0.060) = sqrt(4.30314e-6 + 9.94838e-6) = 3.77512 mm; H = 0.636620 x 1.70072
  // = 1.08271 mm. x = 11 x (1.08271 - 0.35) = 8.0598 mm.
  const PlantModel model = tight(0.050);
  const PlantState state = settled(model, {.voltage = 3000.0});
  EXPECT_NEAR(state.motion.H, 1.08271e-3, 2e-8);
  EXPECT_NEAR(state.motion.x, 8.0598e-3, 2e-7);
  EXPECT_NEAR(plate_b(model, state), state.motion.x, 1e-12);  // preload: no sag at rest
  EXPECT_NEAR(state.motion.v, 0.0, 1e-12);
}

TEST(Equilibrium, APushOfATenthNewtonCompressesTheSpringByHooke) {
  const PlantModel model = tight(0.050);
  const PlantState state = settled(model, {.voltage = 3000.0, .external_force = 0.1});
  EXPECT_NEAR(plate_b(model, state) - state.motion.x, 0.1 / 140.0, 1e-9);
}

TEST(Equilibrium, OilVolumeOfEquationEighteenIsConserved) {
  const Baseline b;
  for (double volts = 200.0; volts <= 8000.0; volts *= 1.3)
    for (const double load : {0.1, 0.3, 1.0, 3.0, 10.0}) {
      const double P = pressure(b, volts), S = load / (b.L0 * P);
      const Equilibrium result = equilibrium(b, P, load);
      if (result.H == b.H_0) continue;
      EXPECT_NEAR((result.H * S + std::numbers::pi * result.H * result.H / 4) * b.L0, b.V0, 1e-12 * b.V0);
      EXPECT_NEAR(result.slope, (equilibrium(b, P, load + 1e-6).H - equilibrium(b, P, load - 1e-6).H) / 2e-6,
                  1e-5 * std::abs(result.slope));
    }
}

TEST(Equilibrium, WithoutPressureOrBelowTheRestingHeightThePouchRests) {
  const Baseline b;
  EXPECT_EQ(equilibrium(b, 0.0, 1.0).H, b.H_0);
  EXPECT_EQ(equilibrium(b, 0.0, 0.0).H, b.H_0);
  EXPECT_EQ(equilibrium(b, 1e-300, 1.0).H, b.H_0);
  EXPECT_EQ(equilibrium(b, pressure(b, 100.0), 1.0).H, b.H_0);
  // Without a load the whole volume stands as a cylinder, whatever the pressure.
  EXPECT_NEAR(equilibrium(b, pressure(b, 1.0), 0.0).H, 2.0 * std::sqrt(b.V0 / (b.L0 * std::numbers::pi)),
              1e-15);
}

TEST(Equilibrium, HigherVoltageLiftsMoreAndHeavierLoadLess) {
  const Baseline b;
  for (double volts = 2000.0; volts < 8000.0; volts += 100.0) {
    EXPECT_LT(equilibrium(b, pressure(b, volts), 1.0).H, equilibrium(b, pressure(b, volts + 100.0), 1.0).H);
    EXPECT_GT(equilibrium(b, pressure(b, volts), 1.0).H, equilibrium(b, pressure(b, volts), 1.1).H);
  }
}

TEST(Pressure, QuadruplesWithTwiceTheVoltageAndIgnoresItsSign) {
  const Baseline b;
  EXPECT_DOUBLE_EQ(pressure(b, 4000.0), 4.0 * pressure(b, 2000.0));
  EXPECT_EQ(pressure(b, -4000.0), pressure(b, 4000.0));
  EXPECT_NEAR(pressure(b, 2400.0), 8669.94, 0.1);
}

TEST(Spring, NeverPullsSoAPlateAboveItFallsFreely) {
  PlantModel model = tight(0.050);
  model.baseline.c_s = 0.0;
  PlantState state = at_rest(model);
  state.motion.x = 0.020;  // far above its spring: m_A g / k is 5.6 mm
  for (int k = 0; k < 20; ++k) state = step(model, state, {}, Seconds(1e-3));
  EXPECT_NEAR(state.motion.v, -9.81 * 0.020, 1e-12);
  EXPECT_NEAR(state.motion.x, 0.020 - 0.5 * 9.81 * 0.020 * 0.020, 1e-12);
}

TEST(Spring, WithoutDampersItsEnergyIsKept) {
  PlantModel model = tight(0.050);
  model.baseline.c_s = model.baseline.c_k = 0.0;
  model.internal_step = 1e-4;
  PlantState state = at_rest(model);
  state.motion.x = 0.002;
  const auto energy = [&] {
    return 0.5 * model.mass_A() * state.motion.v * state.motion.v +
           0.5 * 140.0 * state.motion.x * state.motion.x;
  };
  const double before = energy();
  for (int k = 0; k < 2000; ++k) state = step(model, state, {}, Seconds(1e-3));
  EXPECT_NEAR(energy(), before, 1e-3 * before);
}

TEST(Pouch, IsNeverFlatterThanAtRest) {
  PlantModel model;
  PlantState state = at_rest(model);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> volts(-8000.0, 8000.0), newtons(-2.0, 2.0);
  PlantInputs inputs;
  for (int k = 0; k < 20000; ++k) {
    if (random() % 37 == 0) inputs = {.voltage = volts(random), .external_force = newtons(random)};
    state = step(model, state, inputs, Seconds(1e-3));
    ASSERT_GE(state.motion.H, model.baseline.H_0);
    ASSERT_TRUE(std::isfinite(state.motion.x));
  }
}

TEST(Plant, StaysAtRestWithoutAnInput) {
  const PlantModel model;
  PlantState state = at_rest(model);
  for (int k = 0; k < 1000; ++k) state = step(model, state, {}, Seconds(1e-3));
  EXPECT_EQ(state.motion.x, 0.0);
  EXPECT_EQ(state.motion.v, 0.0);
  EXPECT_EQ(state.motion.H, model.baseline.H_0);
}

}  // namespace
}  // namespace biopsy::sim
