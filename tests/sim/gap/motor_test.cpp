// A motor that nothing but its own inertia and drag holds, as hobbyists record them: a step or a rectangle of
// the drive, an encoder of few counts, and a model whose numbers are guesses. Nothing of the library is
// missing in it, so that any name is a wrong one. The motion is the closed solution of m dv/dt = u - c v.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim/gap/find_gap.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/sim/gap/generator/hidden_physics.hpp"

namespace biopsy::hidden {
namespace {

struct Motor {
  double inertia = 0.05, drag = 0.8;  // kg, N s/m
  double counts = 2e-3;               // m of one step of the encoder
};

using Drive = double (*)(double time);

RecordedRun turned(const Motor& motor, const std::string& name, double gain, Drive drive, Dice& dice) {
  constexpr int kRows = 300;
  RecordedRun run;
  run.name = run.file = name;
  run.period = 0.01;
  double x = 0.0, v = 0.0;
  for (int i = 0; i < kRows; ++i) {
    const double t = run.period * i, u = gain * drive(t);
    run.time.push_back(t);
    run.input.push_back(u);
    run.external_force.push_back(0.0);
    run.displacement.push_back(std::round((x + 0.2 * motor.counts * dice.normal()) / motor.counts) *
                               motor.counts);
    const double decay = std::exp(-run.period * motor.drag / motor.inertia), settled = u / motor.drag;
    x += settled * run.period + (v - settled) * (1.0 - decay) * motor.inertia / motor.drag;
    v = settled + (v - settled) * decay;
  }
  return run;
}

Dataset recorded(const Motor& motor, Drive drive, std::uint64_t seed) {
  Dice dice(seed);
  Dataset out{.title = "motor", .sensor_noise = {}, .runs = {}};
  for (const double gain : {6.0, 9.0, 12.0})
    out.runs.push_back(turned(motor, fmt::format("drive {:g}", gain), gain, drive, dice));
  return out;
}

sim::PlantModel guess(double m, double c_s, double k) {
  return sim::parse_model(fmt::format("[baseline]\ndrive = \"force\"\nm = {}\nc_s = {}\nk = {}\n", m, c_s, k),
                          "motor.toml");
}

double on(double /*time*/) {
  return 1.0;
}

double rectangle(double time) {
  return time < 0.3 ? 0.0 : std::fmod(time, 1.0) < 0.5 ? 1.0 : -1.0;
}

void expect_no_name(const Dataset& data, const sim::PlantModel& model, const std::string& what) {
  const GapFinding finding = sim::gap::find_gap(data, model, {}).finding;
  EXPECT_TRUE(finding.effects.empty()) << what << ": " << finding.effects.front().name;
}

TEST(Motor, WhoseNumbersAreGuessedLacksNoEffect) {
  Dice dice(71);
  for (const Drive drive : {on, rectangle})
    for (int i = 0; i < 4; ++i) {
      const Motor motor{.inertia = dice.between(0.03, 0.3), .drag = dice.between(0.4, 2.0)};
      const Dataset data = recorded(motor, drive, 700U + static_cast<unsigned>(i));
      expect_no_name(data, guess(3.0 * motor.inertia, 0.85 * motor.drag, 0.0), "mass guessed");
      expect_no_name(data, guess(1.1 * motor.inertia, 0.9 * motor.drag, 0.05), "a spring that is not there");
      expect_no_name(data, guess(0.4 * motor.inertia, 2.0 * motor.drag, 0.0), "half of it");
    }
}

// The numbers are found where the recording tells them.
TEST(Motor, SaysItsNumbers) {
  const Motor motor{.inertia = 0.2, .drag = 0.7};
  const GapFinding finding =
      sim::gap::find_gap(recorded(motor, rectangle, 720), guess(0.12, 1.0, 0.0), {}).finding;
  ASSERT_EQ(finding.verdict, GapVerdict::Parameter) << finding.effects.size();
  for (const ChangedParameter& number : finding.parameters_changed) {
    const double truth = number.name == "m" ? motor.inertia : motor.drag;
    EXPECT_NEAR(number.after, truth, std::max(3.0 * number.std, 0.02 * truth)) << number.name;
    EXPECT_LT(number.std, 0.2 * truth) << number.name;
  }
}

// A force that is always there, a turned sign and another unit of the drive are one and the same to it.
TEST(Motor, UnderAConstantDriveHasNoExternalForce) {
  for (const double factor : {-1.0, 0.01}) {
    Dataset data = recorded({}, on, 731);
    data.runs.resize(1);
    data.runs.push_back(data.runs.front());
    data.runs.back().name = "again";
    for (double& x : data.runs.back().displacement) x += 1e-9;
    for (RecordedRun& run : data.runs)
      for (double& x : run.displacement) x *= factor;
    expect_no_name(data, guess(0.05, 0.8, 0.0), fmt::format("times {}", factor));
  }
}

// An encoder without noise repeats its reading until the motor is driven: no end of a range.
TEST(Motor, ThatStandsBeforeItsStepIsNotClipped) {
  for (const double rest_s : {0.05, 0.3, 1.0}) {
    Dataset data = recorded({.counts = 2e-5}, on, 741);
    for (RecordedRun& run : data.runs) {
      const auto rows = static_cast<std::size_t>(rest_s / run.period);
      run.input.insert(run.input.begin(), rows, 0.0);
      run.external_force.insert(run.external_force.begin(), rows, 0.0);
      run.displacement.insert(run.displacement.begin(), rows, 0.0);
      run.time.clear();
      for (std::size_t i = 0; i < run.input.size(); ++i)
        run.time.push_back(run.period * static_cast<double>(i));
    }
    for (const DataRemark& remark : sim::gap::find_gap(data, guess(0.05, 0.8, 0.0), {}).finding.data)
      EXPECT_FALSE(remark.blocks) << rest_s << ": " << remark.sentence;
  }
}

}  // namespace
}  // namespace biopsy::hidden
