// The hidden generator against closed forms: an independent implementation of docs/explanation/model.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "tests/sim/gap/generator/hidden_cases.hpp"
#include "tests/sim/gap/generator/hidden_programs.hpp"

namespace biopsy::hidden {
namespace {

using Input = std::function<double(double t)>;

Program program(
    double seconds, double weight, const Input& input, const Input& push = [](double) { return 0.0; }) {
  Program out{1e-3, weight, {}, {}};
  for (int row = 0; row * 1e-3 < seconds; ++row) {
    out.input.push_back(input(row * 1e-3));
    out.push.push_back(push(row * 1e-3));
  }
  return out;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = a.size() == b.size() ? 0.0 : 1e9;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    if (const double apart = std::abs(a[i] - b[i]); !(apart <= worst))
      worst = std::isnan(apart) ? 1e9 : apart;
  return worst;
}

// m x'' + c x' + k x = 0 from rest at x0.
double swing(double t, double m, double c, double k, double x0) {
  const double decay = c / (2 * m), omega = std::sqrt(k / m - decay * decay);
  return x0 * std::exp(-decay * t) * (std::cos(omega * t) + decay / omega * std::sin(omega * t));
}

std::vector<double> peaks(const std::vector<double>& x) {
  std::vector<double> out;
  for (std::size_t i = 1; i + 1 < x.size(); ++i)
    if (x[i] > x[i - 1] && x[i] >= x[i + 1] && x[i] > 1e-5) {  // vertex of the parabola through three samples
      const double bend = x[i - 1] - 2 * x[i] + x[i + 1], slope = 0.5 * (x[i + 1] - x[i - 1]);
      out.push_back(x[i] - 0.5 * slope * slope / bend);
    }
  return out;
}

TEST(HiddenStage, StaysAtRestWithoutVoltageWhateverTheWeight) {
  for (const double weight : {0.0, 0.02, 0.13}) {
    const Trace trace = run_stage({}, {}, program(2.0, weight, [](double) { return 0.0; }), 1);
    EXPECT_LT(std::abs(*std::ranges::max_element(trace.displacement)), 1e-15);
    EXPECT_LT(std::abs(*std::ranges::min_element(trace.displacement)), 1e-15);
  }
}

TEST(HiddenStage, LeaksAsTheClosedForm) {
  const StageNumbers b;
  const Trace trace = run_stage(b, {}, program(8.0, 0.05, [](double) { return 2000.0; }), 1);
  for (std::size_t row = 1; row < trace.current.size(); row += 500) {
    const double output = b.K * 2000.0 * std::exp(-static_cast<double>(row) * 1e-3 / b.tau);
    EXPECT_NEAR(trace.current[row] / (b.C1 * output / b.tau), 1.0, kSubstep / b.tau) << "row " << row;
  }
}

TEST(HiddenStage, SettlesAtTheHeightThatBalancesTheLoad) {
  StageNumbers b;
  b.tau = 1e9;  // no leakage: a height to settle at
  for (const double weight : {0.02, 0.05, 0.10}) {
    const Trace trace = run_stage(b, {}, program(9.0, weight, [](double) { return 2200.0; }), 1);
    const double u = b.K * 2200.0,
                 pressure = b.eps_film * 8.8541878128e-12 * u * u / (2 * b.d_film * b.d_film);
    const double height = b.H_0 + trace.plate_b.back() / b.n;
    const double load = (b.fixture + weight + b.m_B) * b.g;
    const double bent = std::numbers::pi / 2 * height;  // H solves (pi H / 2)^2 + 2 S (pi H / 2) = pi V0 / L0
    EXPECT_NEAR(bent * bent + 2 * load / (b.L0 * pressure) * bent, std::numbers::pi * b.V0 / b.L0, 1e-11);
    EXPECT_NEAR(trace.displacement.back(), trace.plate_b.back(), 1e-9) << "no push: the spring is at rest";
  }
}

TEST(HiddenStage, PushedPlateSagsByForceOverStiffnessAndSwingsFreely) {
  const StageNumbers b;
  const double weight = 0.05, push = 0.1, released = 9.0;
  const Trace trace = run_stage(b, {},
                                program(
                                    11.0, weight, [](double) { return 0.0; },
                                    [&](double t) { return t < released - 5e-4 ? push : 0.0; }),
                                1);
  EXPECT_NEAR(trace.displacement[8990], -push / b.k, 1e-12);
  for (std::size_t row = 9000; row < trace.displacement.size(); row += 37) {
    const double t = static_cast<double>(row) * 1e-3 - released;
    EXPECT_NEAR(trace.displacement[row], swing(t, b.fixture + weight, b.c_s + b.c_k, b.k, -push / b.k), 2e-9);
  }
}

TEST(HiddenMechanism, KeepsItsEnergyWithoutLosses) {
  const MechanismNumbers b{0.5, 0.0, 400.0};
  const Trace trace =
      run_mechanism(b, {}, program(20.0, 0.0, [](double t) { return t < 0.3 ? 1.0 : 0.0; }), 1);
  const auto tops = peaks({trace.displacement.begin() + 400, trace.displacement.end()});
  ASSERT_GT(tops.size(), 50U);
  const auto [low, high] = std::ranges::minmax(tops);
  EXPECT_LT((high - low) / high, 1e-5);
}

TEST(HiddenMechanism,
     LosesFourFrictionsOverStiffnessASwing) {  // textbook: Coulomb's decay is a straight line
  const MechanismNumbers b{0.5, 0.0, 400.0};
  HiddenPhysics rubbing;
  rubbing.friction = 0.02;
  const Trace trace =
      run_mechanism(b, rubbing, program(5.0, 0.0, [](double t) { return t < 0.4 ? 2.0 : 0.0; }), 1);
  const auto tops = peaks({trace.displacement.begin() + 450, trace.displacement.end()});
  ASSERT_GT(tops.size(), 8U);
  for (std::size_t i = 1; i < 8; ++i) EXPECT_NEAR(tops[i - 1] - tops[i], 4 * rubbing.friction / b.k, 3e-6);
}

TEST(HiddenMechanism, SticksBelowTheFriction) {
  HiddenPhysics rubbing;
  rubbing.friction = 0.1;
  const Trace trace = run_mechanism({}, rubbing, program(20.0, 0.0, [](double) { return 0.08; }), 1);
  EXPECT_LT(trace.displacement.back(), 5e-6) << "bends its bristles only";
  EXPECT_NEAR(trace.displacement.back(), trace.displacement[10000], 1e-9) << "and does not creep";
}

TEST(HiddenSensor, ReadsLateByExactlyTheDelay) {
  HiddenPhysics late;
  late.delay = 5e-3;
  const Program ramp = program(3.0, 0.02, [](double t) { return 900.0 * t; });
  const Trace plain = run_stage({}, {}, ramp, 1), delayed = run_stage({}, late, ramp, 1);
  for (std::size_t row = 5; row < 3000; row += 101)
    EXPECT_NEAR(delayed.displacement[row], plain.displacement[row - 5], 1e-12);
}

struct EveryHiddenEffect : testing::TestWithParam<std::string> {
  HiddenPhysics physics() const {
    const auto cases = hidden_cases();
    const auto found = std::ranges::find_if(cases, [](const HiddenCase& c) {
      return (c.group == "singles" || c.group == "outside") && !c.visible &&
             c.terms.front().name == GetParam();
    });
    return found->physics();
  }
};

TEST_P(EveryHiddenEffect, ChangesLittleWhenTheStepIsHalved) {
  Dice dice(5);
  const auto runs = stage_programs(3, 1e-3, 0.3, dice);
  double seen = 0.0;
  for (const NamedProgram& run : runs) {
    const Trace whole = run_stage({}, physics(), run.program, 3),
                half = run_stage({}, physics(), run.program, 3, kSubstep / 2);
    EXPECT_LT(largest_difference(whole.displacement, half.displacement), 3e-6) << run.name;
    const Trace none = run_stage({}, {}, run.program, 3);
    seen = std::max(seen, largest_difference(whole.displacement, none.displacement));
  }
  EXPECT_GT(seen, 50e-6) << "or the step was never put to the test";
}

std::vector<std::string> all_names() {
  auto out = hidden_effect_names();
  std::ranges::copy(outside_names(), std::back_inserter(out));
  return out;
}
INSTANTIATE_TEST_SUITE_P(Of, EveryHiddenEffect, testing::ValuesIn(all_names()),
                         [](const auto& each) { return each.param; });

}  // namespace
}  // namespace biopsy::hidden
