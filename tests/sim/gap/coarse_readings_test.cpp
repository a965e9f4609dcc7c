// Readings of a coarse sensor repeat: at the ends of a motion, at rest, within a step. That is neither a
// range that is exceeded nor a dead sensor. Motions in closed form, and the sensor rounds them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "sim/gap/examine/examine.hpp"
#include "sim/plant/dataset.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kAmplitude = 9e-3;  // m
constexpr double kSeconds = 12.0;
const std::vector<double> kLevels{6, 9, 14, 22, 35, 60};    // of the sensor, from end to end of the motion
const std::vector<double> kRates{40, 100, 170, 400, 1000};  // Hz

struct Motion {
  std::string name;
  std::function<double(double)> input, place;  // N, m at a time [s]
};

// A mass on a spring, 3.1 Hz, damping ratio z, released at every change of `force`: closed form.
double settled(double t, double z) {
  const double w = kTwoPi * 3.1, d = w * std::sqrt(1.0 - z * z);
  return 1.0 - std::exp(-z * w * t) * (std::cos(d * t) + z * w / d * std::sin(d * t));
}

std::vector<Motion> motions() {
  const auto still = [](double) { return 1.0; };
  return {{"sine", [](double t) { return std::sin(kTwoPi * 1.7 * t); },
           [](double t) { return kAmplitude * std::sin(kTwoPi * 1.7 * t + 0.4); }},
          {"two sines", [](double t) { return std::sin(kTwoPi * 2.3 * t); },
           [](double t) {
             return kAmplitude * (0.6 * std::sin(kTwoPi * 2.3 * t) + 0.4 * std::sin(kTwoPi * 5.9 * t + 1.0));
           }},
          {"ring-down", still, [](double t) { return kAmplitude * settled(t, 0.06); }},
          {"steps", [](double t) { return std::fmod(t, 2.0) < 1.0 ? 1.0 : 0.0; },
           [](double t) {
             double x = 0.0;
             for (int i = 0; i < 12 && t > i; ++i) x += (i % 2 == 0 ? 1.0 : -1.0) * settled(t - i, 0.12);
             return kAmplitude * x;
           }},
          {"moved and left", [](double t) { return t < 7.0 ? std::sin(kTwoPi * 2.9 * t) : 0.0; },
           [](double t) {
             const double dies = t < 7.0 ? 1.0 : std::exp(-6.0 * (t - 7.0));
             return kAmplitude * (0.3 + dies * std::sin(kTwoPi * 2.9 * t));
           }}};
}

using Sensor = std::function<double(double)>;

Dataset recorded(const Motion& motion, double rate, const Sensor& sensor) {
  RecordedRun run;
  run.name = "run";
  run.period = 1.0 / rate;
  for (double t = 0.0; t < kSeconds; t += 1.0 / rate) {
    run.time.push_back(t);
    run.input.push_back(motion.input(t));
    run.displacement.push_back(sensor(motion.place(t)));
    run.external_force.push_back(0.0);
  }
  Dataset out;
  out.runs = {std::move(run)};
  return out;
}

// Rounds to steps, as an encoder does; the file gives four digits after the point in mm.
Sensor coarse(double levels) {
  const double step = 2.0 * kAmplitude / levels;
  return [step](double x) { return std::round(std::round(x / step) * step * 1e7) / 1e7; };
}

std::vector<std::string> blocking(const Dataset& data, double noise) {
  std::vector<std::string> out;
  for (const DataRemark& one : examine_channels(data, Drive::Force, noise))
    if (one.blocks) out.push_back(one.cause);
  return out;
}

TEST(CoarseReadings, AreNeitherClippedNorFrozen) {
  for (const Motion& motion : motions())
    for (const double levels : kLevels)
      for (const double rate : kRates) {
        const double noise = 2.0 * kAmplitude / levels / std::sqrt(12.0);
        for (const std::string& cause : blocking(recorded(motion, rate, coarse(levels)), noise))
          ADD_FAILURE() << fmt::format("{} at {} Hz on {} levels: {}", motion.name, rate, levels, cause);
      }
}

// A switch that has two ends, at one of which the sensor reads 0: no mark.
TEST(CoarseReadings, AtRestAtZeroAreNoMarks) {
  const Motion flips{"flips", [](double t) { return std::fmod(t, 2.0) < 1.2 ? 1.0 : 0.0; },
                     [](double t) {
                       return std::fmod(t, 2.0) < 1.2 ? kAmplitude * (1.0 + 0.01 * std::sin(40.0 * t)) : 0.0;
                     }};
  for (const double rate : kRates)
    EXPECT_EQ(blocking(recorded(flips, rate, coarse(400.0)), 1e-5), std::vector<std::string>{}) << rate;
}

// A range that ends in the middle of a fast motion is seen behind the steps too.
TEST(CoarseReadings, ThatAreClippedAreNamed) {
  const Motion sine = motions().front();
  for (const double rate : {100.0, 400.0}) {
    const Sensor steps = coarse(500.0);
    const auto cut = [&](double x) { return steps(std::min(x, 0.5 * kAmplitude)); };
    EXPECT_EQ(blocking(recorded(sine, rate, cut), 1e-5), std::vector<std::string>{"clipped"}) << rate;
  }
}

}  // namespace
}  // namespace biopsy::sim::gap
