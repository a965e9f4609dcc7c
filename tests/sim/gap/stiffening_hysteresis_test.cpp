// Bouc-Wen springs of the general form, loading that stiffens included: simulated here in the form of Noel
// and Schoukens' benchmark (a force as the inner variable; classical Runge-Kutta), not in the library's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/gap/find_gap.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/sim/gap/generator/hidden_physics.hpp"

namespace biopsy::hidden::bouc_wen {
namespace {

constexpr double kReadingNoise = 3e-6, kRate = 300.0, kSeconds = 10.0;  // m, Hz, s
constexpr int kFine = 10;

// m x'' + c x' + k x + cubic x^3 + z = F, z' = alpha x' - beta (gamma |x'| z + delta x' |z|)
struct Loop {
  double m = 0.6, c = 3.0, k = 300.0, cubic = 0.0;
  double alpha = 0.0, beta = 0.0, gamma = 0.0, delta = 0.0;
};

struct At {
  double x, v, z;
};

At rate(const Loop& p, const At& s, double force) {
  return {s.v, (force - p.c * s.v - p.k * s.x - p.cubic * s.x * s.x * s.x - s.z) / p.m,
          p.alpha * s.v - p.beta * (p.gamma * std::abs(s.v) * s.z + p.delta * s.v * std::abs(s.z))};
}

At moved(const At& s, const At& by, double h) {
  return {s.x + h * by.x, s.v + h * by.v, s.z + h * by.z};
}

double push(int run, double t, double phase) {
  const double w = 2.0 * std::numbers::pi;
  if (run == 3) return 1.6 * std::sin(w * 0.7 * t + phase);
  double out = 0.0;
  for (const double hertz : {0.3, 0.8, 1.7, 2.9}) out += std::sin(w * hertz * t + phase * (1.0 + hertz));
  return (0.6 + 0.2 * run) * std::min(1.0, t) * out;
}

GapFinding found(const Loop& p, std::uint64_t seed) {
  Dice dice(seed);
  sim::Dataset data;
  data.title = "loop";
  data.sensor_noise = kReadingNoise;
  for (int r = 0; r < 4; ++r) {
    sim::RecordedRun run;
    run.name = "r" + std::to_string(r);
    run.file = run.name + ".csv";
    run.period = 1.0 / kRate;
    const double phase = dice.between(0.0, 6.0), h = run.period / kFine;
    At s{0.0, 0.0, 0.0};
    for (double t = 0.0; t < kSeconds; t += run.period) {
      const double f = push(r, t, phase);
      run.time.push_back(t);
      run.input.push_back(f);
      run.external_force.push_back(0.0);
      run.displacement.push_back(s.x + kReadingNoise * dice.normal());
      for (int i = 0; i < kFine; ++i) {
        const At a = rate(p, s, f), b = rate(p, moved(s, a, 0.5 * h), f),
                 c = rate(p, moved(s, b, 0.5 * h), f), d = rate(p, moved(s, c, h), f);
        s = moved(moved(moved(moved(s, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
      }
    }
    data.runs.push_back(std::move(run));
  }
  const auto off = [&](double value) { return std::to_string(value * (1.0 + dice.between(-0.01, 0.01))); };
  const std::string model =
      "[baseline]\ndrive = \"force\"\nm = " + off(p.m) + "\nc_s = " + off(p.c) + "\nk = " + off(p.k) + "\n";
  return sim::gap::find_gap(data, sim::parse_model(model, "loop.toml"), {}).finding;
}

bool names(const GapFinding& finding, const std::string& effect) {
  return std::ranges::any_of(finding.effects, [&](const FoundEffect& one) { return one.name == effect; });
}

TEST(StiffeningHysteresis, IsNamedHystereticSpring) {
  for (const std::uint64_t seed : {1, 2}) {
    Dice dice(seed);
    const Loop loop{.alpha = dice.between(60.0, 120.0),
                    .beta = dice.between(100.0, 300.0),
                    .gamma = 0.8,
                    .delta = -1.1};  // gamma + delta < 0
    const GapFinding finding = found(loop, seed);
    ASSERT_EQ(finding.verdict, GapVerdict::Effect) << seed;
    EXPECT_EQ(finding.effects.size(), 1U) << seed;
    EXPECT_TRUE(names(finding, "hysteretic_spring")) << finding.effects.front().name;
    EXPECT_GT(finding.gap_closed, 0.95) << seed;
  }
}

TEST(StiffeningHysteresis, OneThatYieldsStillIs) {
  const GapFinding finding = found({.alpha = 100.0, .beta = 250.0, .gamma = 0.7, .delta = 0.3}, 3);
  ASSERT_EQ(finding.verdict, GapVerdict::Effect);
  EXPECT_TRUE(names(finding, "hysteretic_spring")) << finding.effects.front().name;
  EXPECT_GT(finding.gap_closed, 0.95);
}

TEST(StiffeningHysteresis, ASpringWithoutMemoryIsNotCalledSo) {
  EXPECT_FALSE(names(found({.cubic = 1.5e6}, 4), "hysteretic_spring"));
  EXPECT_TRUE(found({}, 5).effects.empty());
}

}  // namespace
}  // namespace biopsy::hidden::bouc_wen
