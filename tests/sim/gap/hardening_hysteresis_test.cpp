// A mechanism whose hysteretic spring stiffens as it is loaded: the equations, numbers and excitation of the
// published Bouc-Wen benchmark (Noel, Schoukens 2016), and one of other size, integrated here by Runge-Kutta.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "sim/gap/find_gap.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/sim/gap/generator/hidden_physics.hpp"

namespace biopsy::hidden {
namespace {

// m y'' + c y' + k y + z = u, z' = alpha y' - beta (gamma |y'| z + delta y' |z|), as the benchmark writes it
struct BoucWen {
  double m, c, k, alpha, beta, gamma, delta;
  double rate;       // Hz
  double low, high;  // Hz, of the multisine
  double rms;        // N
  double noise;      // m

  double scale() const { return -1.0 / (beta * (gamma + delta)); }  // m
  double loop() const { return (gamma - delta) * beta * scale() / 2.0 - 0.5; }
};

constexpr BoucWen kBenchmark{.m = 2.0,
                             .c = 10.0,
                             .k = 5e4,
                             .alpha = 5e4,
                             .beta = 1e3,
                             .gamma = 0.8,
                             .delta = -1.1,
                             .rate = 750.0,
                             .low = 5.0,
                             .high = 150.0,
                             .rms = 50.0,
                             .noise = 8e-6};
constexpr BoucWen kSlower{.m = 0.7,
                          .c = 3.0,
                          .k = 400.0,
                          .alpha = 900.0,
                          .beta = 200.0,
                          .gamma = 0.7,
                          .delta = -1.2,
                          .rate = 200.0,
                          .low = 0.4,
                          .high = 25.0,
                          .rms = 6.0,
                          .noise = 10e-6};

std::vector<double> multisine(const BoucWen& rig, std::size_t rows, Dice& dice) {
  std::vector<double> force(rows, 0.0);
  const double line = rig.rate / static_cast<double>(rows);
  int lines = 0;
  for (double f = std::ceil(rig.low / line) * line; f <= rig.high; f += 3.0 * line, ++lines) {
    const double at = dice.between(0.0, 2.0 * std::numbers::pi);
    for (std::size_t i = 0; i < rows; ++i)
      force[i] += std::cos(2.0 * std::numbers::pi * f * static_cast<double>(i) / rig.rate + at);
  }
  for (double& f : force) f *= rig.rms * std::sqrt(2.0 / lines);
  return force;
}

std::vector<double> moved(const BoucWen& rig, const std::vector<double>& force) {
  struct State {
    double y = 0.0, v = 0.0, z = 0.0;
  } s;
  const auto slope = [&](const State& at, double u) {
    return State{at.v, (u - rig.c * at.v - rig.k * at.y - at.z) / rig.m,
                 rig.alpha * at.v -
                     rig.beta * (rig.gamma * std::abs(at.v) * at.z + rig.delta * at.v * std::abs(at.z))};
  };
  const auto gone = [](const State& at, const State& by, double h) {
    return State{at.y + h * by.y, at.v + h * by.v, at.z + h * by.z};
  };
  constexpr int kSubsteps = 20;
  const double h = 1.0 / rig.rate / kSubsteps;
  std::vector<double> y;
  for (const double u : force) {
    y.push_back(s.y);
    for (int i = 0; i < kSubsteps; ++i) {
      const State a = slope(s, u), b = slope(gone(s, a, 0.5 * h), u), c = slope(gone(s, b, 0.5 * h), u),
                  d = slope(gone(s, c, h), u);
      s = gone(gone(gone(gone(s, a, h / 6.0), b, h / 3.0), c, h / 3.0), d, h / 6.0);
    }
  }
  return y;
}

Dataset recorded(const BoucWen& rig, std::uint64_t seed) {
  Dice dice(seed);
  Dataset out{.title = "hysteretic mechanism", .sensor_noise = {}, .runs = {}};
  for (const double size : {1.0, 1.0, 0.7, 1.2}) {
    RecordedRun run;
    run.name = run.file = "run " + std::to_string(out.runs.size());
    run.period = 1.0 / rig.rate;
    run.input = multisine(rig, 3000, dice);
    for (double& force : run.input) force *= size;
    run.displacement = moved(rig, run.input);
    for (std::size_t i = 0; i < run.input.size(); ++i) {
      run.time.push_back(static_cast<double>(i) / rig.rate);
      run.displacement[i] += rig.noise * dice.normal();
    }
    run.external_force.assign(run.input.size(), 0.0);
    out.runs.push_back(std::move(run));
  }
  return out;
}

// The model is the mechanism as one measures it with small motions.
GapFinding found(const BoucWen& rig, std::uint64_t seed) {
  sim::PlantModel model = sim::parse_model("[baseline]\ndrive = \"force\"\n", "mechanism.toml");
  model.baseline.m = rig.m, model.baseline.c_s = rig.c, model.baseline.k = rig.k + rig.alpha;
  return sim::gap::find_gap(recorded(rig, seed), model, {}).finding;
}

void expect_named(const BoucWen& rig, std::uint64_t seed) {
  const GapFinding finding = found(rig, seed);
  ASSERT_EQ(finding.verdict, GapVerdict::Effect);
  ASSERT_EQ(finding.effects.size(), 1U);
  EXPECT_EQ(finding.effects[0].name, "hardening_hysteresis");
  EXPECT_GT(finding.gap_closed, 0.99);
  const auto& numbers = finding.effects[0].parameters;  // stiffness, scale, exponent, loop
  ASSERT_EQ(numbers.size(), 4U);
  EXPECT_NEAR(numbers[0].value, 1e-3 * rig.alpha, 0.03e-3 * rig.alpha);
  EXPECT_NEAR(numbers[1].value, 1e3 * rig.scale(), 30.0 * rig.scale());
  EXPECT_NEAR(numbers[2].value, 1.0, 0.03);
  EXPECT_NEAR(numbers[3].value, rig.loop(), 0.05 * rig.loop());
}

TEST(HardeningHysteresis, OfThePublishedBenchmarkIsNamedWithItsNumbers) {
  expect_named(kBenchmark, 81);
}

TEST(HardeningHysteresis, OfASlowerMechanismIsNamedWithItsNumbers) {
  expect_named(kSlower, 82);
}

}  // namespace
}  // namespace biopsy::hidden
