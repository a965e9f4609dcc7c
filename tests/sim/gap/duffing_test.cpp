// A mechanism whose spring stiffens so much that its resonance shifts (as in the Silverbox benchmark, and
// stronger): model and measurement get out of phase, and the effect must still be found.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "sim/gap/find_gap.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::hidden {
namespace {

constexpr double kRate = 500.0, kSeconds = 6.0;  // Hz, s
constexpr int kLines = 120;                      // of the multisine, 0.5 to 40 Hz
constexpr int kSteps = 8;                        // of the integrator between two readings
constexpr double kMass = 0.5, kDamping = 6.0, kSpring = 2000.0, kCubic = 8e7;  // kg, N s/m, N/m, N/m^3
constexpr double kReadingNoise = 2e-6;                                         // m

std::vector<double> multisine(double rms, std::mt19937& random) {
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  std::vector<double> force(static_cast<std::size_t>(kRate * kSeconds), 0.0);
  for (int line = 0; line < kLines; ++line) {
    const double f = 0.5 + 39.5 * line / kLines, at = phase(random);
    for (std::size_t i = 0; i < force.size(); ++i)
      force[i] += rms * std::sqrt(2.0 / kLines) *
                  std::cos(2.0 * std::numbers::pi * f * static_cast<double>(i) / kRate + at);
  }
  return force;
}

// Classical Runge-Kutta on x'' = (u - c x' - k x - k3 x^3) / m.
std::vector<double> duffing(const std::vector<double>& force) {
  struct State {
    double x = 0.0, v = 0.0;
  } s;
  const auto slope = [](State at, double u) {
    return State{at.v, (u - kDamping * at.v - kSpring * at.x - kCubic * at.x * at.x * at.x) / kMass};
  };
  const auto moved = [](State at, State by, double h) { return State{at.x + h * by.x, at.v + h * by.v}; };
  std::vector<double> x;
  const double h = 1.0 / kRate / kSteps;
  for (const double u : force) {
    x.push_back(s.x);
    for (int i = 0; i < kSteps; ++i) {
      const State a = slope(s, u), b = slope(moved(s, a, 0.5 * h), u), c = slope(moved(s, b, 0.5 * h), u),
                  d = slope(moved(s, c, h), u);
      s.x += h / 6.0 * (a.x + 2.0 * b.x + 2.0 * c.x + d.x);
      s.v += h / 6.0 * (a.v + 2.0 * b.v + 2.0 * c.v + d.v);
    }
  }
  return x;
}

sim::Dataset shaken(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, kReadingNoise);
  sim::Dataset out{.title = "Duffing", .sensor_noise = kReadingNoise, .runs = {}};
  for (const double rms : {4.0, 6.0, 2.0}) {
    sim::RecordedRun run;
    run.name = "run " + std::to_string(out.runs.size());
    run.period = 1.0 / kRate;
    run.input = multisine(rms, random);
    run.displacement = duffing(run.input);
    for (std::size_t i = 0; i < run.input.size(); ++i) {
      run.time.push_back(static_cast<double>(i) / kRate);
      run.displacement[i] += noise(random);
    }
    run.external_force.assign(run.input.size(), 0.0);
    out.runs.push_back(std::move(run));
  }
  return out;
}

TEST(Duffing, IsFoundThoughItsResonanceShiftsWithUnknownParameters) {
  const sim::PlantModel guess =
      sim::parse_model("[baseline]\ndrive = \"force\"\nm = 0.5\nc_s = 5\nk = 2200\n", "guess.toml");
  const GapFinding finding =
      sim::gap::find_gap(shaken(3), guess, {.free = {"m", "c_s", "k"}, .window = {}}).finding;
  ASSERT_EQ(finding.verdict, GapVerdict::Effect);
  ASSERT_EQ(finding.effects.size(), 1U);
  EXPECT_EQ(finding.effects[0].name, "spring_hardening");
  EXPECT_NEAR(finding.effects[0].parameters[0].value, kCubic * 1e-9, 0.01 * kCubic * 1e-9);
  EXPECT_GT(finding.gap_closed, 0.99);
}

}  // namespace
}  // namespace biopsy::hidden
