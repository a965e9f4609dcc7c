#include "sim/gap/select/next_experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "robot/common/in_parallel.hpp"
#include "safety/types/limits.hpp"
#include "sim/gap/millimetres.hpp"
#include "sim/plant/plant.hpp"
#include "sim/plant/seeded_noise.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kAmplitudes[] = {1.0, 0.5, 0.2};  // of what was recorded
constexpr double kFarAbove = 1e3;                  // noises, beyond which their number says nothing
constexpr double kBeyond = 0.02;        // of the recorded range: a peak is not recorded to the last reading
constexpr double kTick = 1e-3;          // s, the control period T
constexpr double kHalfPeriod = 0.25;    // s, the 2 Hz square wave of paper IV.B
constexpr double kStepShare = 0.1;      // of the fastest rate's time
constexpr double kShortestStep = 2e-5;  // s
constexpr double kWeight = 0.050;       // kg
constexpr double kDropped = 0.050;      // kg, put on by hand: Fig. 11
constexpr double kGravity = 9.81;       // m/s^2
constexpr double kHoldVolts = 4500.0;   // these three lift 50 g by 10 to 12 mm, overshoot included
constexpr double kTriangleVolts = 5000.0;
constexpr double kSweepVolts = 3500.0;
constexpr double kSlowest = 0.5, kFastest = 10.0;          // Hz, of the stack's sweep
constexpr double kProportional = 800e3, kIntegral = 5e3;   // V/m, V/m a tick: paper IV.D
constexpr double kEnvelope = limits::kDriveMax_mV * 1e-3;  // V
constexpr double kDeepest = (limits::kStroke_um + limits::kDepthHard_um) * 1e-6;  // m

using Signal = std::function<double(double time)>;

struct Experiment {
  std::string name, instruction;
  double seconds = 0.0;
  Signal input;     // V or N; of a closed loop the setpoint, m
  Signal external;  // N, down
  bool closed_loop = false;
};

double no_force(double) {
  return 0.0;
}

double polarity(double time) {
  return static_cast<long>(time / kHalfPeriod) % 2 == 0 ? 1.0 : -1.0;
}

// 0 -> 1 -> 0 within each period.
double triangle(double time, double period) {
  const double share = time / period - std::floor(time / period);
  return share < 0.5 ? 2.0 * share : 2.0 - 2.0 * share;
}

// Phase in turns of a sweep that multiplies its frequency evenly, from `low` to `high` Hz within `seconds`.
double sweep_turns(double time, double seconds, double low, double high) {
  const double growth = std::log(high / low) / seconds;
  return low / growth * (std::exp(growth * time) - 1.0);
}

// 0 -> 1 within the first second: a step would move the plate beyond its stroke.
double soft_start(double time) {
  return std::min(1.0, time);
}

double sweep_volts(double time) {
  const double turns = sweep_turns(time, 16.0, kSlowest, kFastest);
  return soft_start(time) * (turns - std::floor(turns) < 0.5 ? kSweepVolts : -kSweepVolts);
}

double staircase_volts(double time) {
  const int step = std::min(static_cast<int>(time / 2.0), 8);
  return polarity(time) * 800.0 * static_cast<double>(step < 5 ? step + 1 : 9 - step);
}

double setpoint(double time) {
  constexpr double kDepths[] = {2e-3, 4e-3, 6e-3, 3e-3};  // m
  return kDepths[std::min<std::size_t>(static_cast<std::size_t>(time / 4.0), std::size(kDepths) - 1)];
}

// Amplitudes times `scale`.
std::vector<Experiment> stack_menu(double scale) {
  const auto scaled = [scale](double (*signal)(double)) {
    return [=](double t) { return scale * signal(t); };
  };
  const auto kilovolts = [scale](double volts) { return 1e-3 * scale * volts; };
  return {
      {"dc_hold",
       fmt::format(
           "Put 50 g on the plate, ramp DC to {:.2g} kV within 1 s, hold it for 9 s, then 0 V for 8 s.",
           kilovolts(kHoldVolts)),
       18.0, scaled([](double t) { return t < 10.0 ? kHoldVolts * soft_start(t) : 0.0; }), no_force},
      {"voltage_staircase_up_and_down",
       fmt::format(
           "Put 50 g on the plate and drive a 2 Hz square wave of amplitude {0:.2g}, {1:.2g}, {2:.2g}, "
           "{3:.2g}, {4:.2g}, {3:.2g}, {2:.2g}, {1:.2g}, {0:.2g} kV, 2 s each.",
           kilovolts(800.0), kilovolts(1600.0), kilovolts(2400.0), kilovolts(3200.0), kilovolts(4000.0)),
       18.0, scaled(staircase_volts), no_force},
      {"frequency_sweep",
       fmt::format(
           "Put 50 g on the plate and drive a square wave, its amplitude ramped to {:.2g} kV within 1 s, "
           "its frequency swept logarithmically from 0.5 to 10 Hz within 16 s.",
           kilovolts(kSweepVolts)),
       16.0, scaled(sweep_volts), no_force},
      {"weight_drop",
       fmt::format(
           "Put 50 g on the plate, drive a 2 Hz square wave for 15 s, its amplitude ramped to {:.2g} kV "
           "within 1 s; after 5 s put another 50 g on at once, after 10 s take it off at once.",
           kilovolts(kSweepVolts)),
       15.0, scaled([](double t) { return kSweepVolts * soft_start(t) * polarity(t); }),
       [](double t) { return t >= 5.0 && t < 10.0 ? kDropped * kGravity : 0.0; }},
      {"slow_triangle",
       fmt::format(
           "Put 50 g on the plate and ramp DC from 0 to {:.2g} kV within 5 s and back within 5 s, twice.",
           kilovolts(kTriangleVolts)),
       20.0, scaled([](double t) { return kTriangleVolts * triangle(t, 10.0); }), no_force},
      {"closed_loop_steps",
       fmt::format(
           "Put 50 g on the plate, close the loop (K_p = 0.8 kV/mm, K_i = 5 kV/(mm s), 2 Hz polarity) and "
           "set {:.2g}, {:.2g}, {:.2g}, {:.2g} mm, 4 s each.",
           2.0 * scale, 4.0 * scale, 6.0 * scale, 3.0 * scale),
       16.0, scaled(setpoint), no_force, true},
  };
}

// Natural frequency of the rig, or how fast it coasts down without a spring; Hz.
double natural_frequency(const Baseline& b) {
  const double rate = b.k > 0.0 ? std::sqrt(b.k / b.m) : b.c_s / b.m;
  return std::clamp(rate / (2.0 * std::numbers::pi), 0.1, 100.0);
}

std::vector<Experiment> force_menu(const Baseline& baseline, double F) {
  const double low = 0.1 * natural_frequency(baseline), high = std::min(100.0, 30.0 * low);
  const auto stair = [F](double t) {  // 1 s at each, the last at 0
    constexpr double kSteps[] = {0.25, -0.25, 0.5, -0.5, 1.0, -1.0, 0.5, -0.5, 0.25, -0.25, 0.0, 0.0};
    return F * kSteps[std::min<std::size_t>(static_cast<std::size_t>(t), std::size(kSteps) - 1)];
  };
  return {
      {"force_steps",
       fmt::format(
           "Step the force to ±{0:.3g} N, ±{1:.3g} N, ±{2:.3g} N, ±{1:.3g} N, ±{0:.3g} N, 1 s each, then "
           "leave it at 0 for 2 s.",
           0.25 * F, 0.5 * F, F),
       12.0, stair, no_force},
      {"force_chirp",
       fmt::format("Drive a sine of {:.3g} N, its frequency swept logarithmically from {:.3g} to {:.3g} Hz "
                   "within 16 s.",
                   F, low, high),
       16.0, [=](double t) { return F * std::sin(2.0 * std::numbers::pi * sweep_turns(t, 16.0, low, high)); },
       no_force},
      {"slow_force_triangle",
       fmt::format("Ramp the force from 0 to {0:.3g} N within 5 s and back within 5 s, then the same with "
                   "-{0:.3g} N.",
                   F),
       20.0, [F](double t) { return (t < 10.0 ? F : -F) * triangle(t, 10.0); }, no_force},
      {"free_decay", fmt::format("Push with {:.3g} N for 4 s, release at once and record 8 s.", F), 12.0,
       [F](double t) { return t < 4.0 ? F : 0.0; }, no_force},
  };
}

// At the largest amplitude that was recorded, and at less where a stroke as long was not.
std::vector<Experiment> scaled_menus(const Baseline& baseline, double largest_force,
                                     const RecordedRange& recorded) {
  const bool limited = std::isfinite(recorded.x_high - recorded.x_low);
  const bool force = baseline.drive == Drive::Force;
  const double full =
      force ? std::min(largest_force, recorded.input) : std::min(1.0, recorded.input / kTriangleVolts);
  std::vector<Experiment> out;
  for (const double share : kAmplitudes) {
    for (Experiment& one : force ? force_menu(baseline, share * full) : stack_menu(share * full))
      out.push_back(std::move(one));
    if (!limited) break;
  }
  return out;
}

// The paper's loop: amplitude for an error, with conditional integration while the amplitude is at a bound.
double loop_volts(double error, double& integral) {
  const double amplitude = kProportional * error + integral + kIntegral * error;
  if (amplitude >= 0.0 && amplitude <= kEnvelope) integral += kIntegral * error;
  return std::clamp(amplitude, 0.0, kEnvelope);
}

// Reading of plate A at each tick, m, and the largest input, V or N. A closed loop uses readings with noise;
// the returned ones have none.
std::vector<double> simulated(PlantModel model, const Experiment& experiment, double noise,
                              std::uint64_t seed, double* largest_input = nullptr) {
  model.weight = kWeight;
  model.effects.sensor_noise.reset();
  model.internal_step = std::clamp(kStepShare / fastest_rate(model), kShortestStep, kTick);
  PlantState state = at_rest(model);
  double integral = 0.0;
  std::vector<double> readings;
  const long ticks = std::lround(experiment.seconds / kTick);
  for (long tick = 0; tick < ticks; ++tick) {
    const double t = static_cast<double>(tick) * kTick, setpoint_now = experiment.input(t);
    readings.push_back(displacement_reading(model, state));
    const auto closed = [&] {
      const double measured = readings.back() + noise * normals(seed, static_cast<std::uint64_t>(tick)).first;
      return polarity(t) * loop_volts(setpoint_now - measured, integral);
    };
    const double input = experiment.closed_loop ? closed() : setpoint_now;
    if (largest_input != nullptr) *largest_input = std::max(*largest_input, std::abs(input));
    // The plant uses the input of its drive.
    state = step(model, state, {.voltage = input, .force = input, .external_force = experiment.external(t)},
                 Seconds(kTick));
  }
  return readings;
}

// RMS; 0 where a candidate diverged, because that will not be measured.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  const double rms = std::sqrt(sum / static_cast<double>(a.size()));
  return std::isfinite(rms) ? rms : 0.0;
}

// One candidate in one experiment.
struct Outcome {
  std::vector<double> readings;  // m
  double scatter = 0.0;  // m, RMS between two repetitions: a loop in a limit cycle does not repeat itself
  bool allowed = true;   // within the stroke, and within what was recorded
};

Outcome outcome_of(const PlantModel& candidate, const Experiment& experiment, double noise,
                   const RecordedRange& recorded) {
  double input = 0.0;
  Outcome out{.readings = simulated(candidate, experiment, noise, 1, &input)};
  if (experiment.closed_loop)
    out.scatter = difference(out.readings, simulated(candidate, experiment, noise, 2));
  const auto [least, largest] = std::ranges::minmax(out.readings);
  const double beyond = kBeyond * (recorded.x_high - recorded.x_low);
  out.allowed = input <= recorded.input * (1.0 + 1e-9) && largest <= recorded.x_high + beyond &&
                least >= recorded.x_low - beyond;
  if (candidate.baseline.drive == Drive::Stack) out.allowed = out.allowed && largest <= kDeepest;
  return out;
}

// The two candidates that an experiment separates least.
struct Closest {
  std::size_t first = 0, second = 1;
  double apart = std::numeric_limits<double>::infinity();  // m
};

Closest closest_pair(const std::vector<Outcome>& outcomes) {
  Closest closest;
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    for (std::size_t j = i + 1; j < outcomes.size(); ++j) {
      const Outcome &a = outcomes[i], &b = outcomes[j];
      const double d = difference(a.readings, b.readings);
      const double own = a.scatter * a.scatter + b.scatter * b.scatter;
      const double apart = a.allowed && b.allowed ? std::sqrt(std::max(0.0, d * d - own)) : 0.0;
      if (apart < closest.apart) closest = {i, j, apart};
    }
  return closest;
}

std::vector<Closest> closest_pairs(const std::vector<Experiment>& menu,
                                   const std::vector<PlantModel>& candidates, double noise,
                                   const RecordedRange& recorded) {
  std::vector<std::vector<Outcome>> outcomes(menu.size(), std::vector<Outcome>(candidates.size()));
  in_parallel(menu.size() * candidates.size(), [&](std::size_t job) {
    const std::size_t e = job / candidates.size(), r = job % candidates.size();
    outcomes[e][r] = outcome_of(candidates[r], menu[e], noise, recorded);
  });
  std::vector<Closest> out;
  out.reserve(outcomes.size());
  for (const auto& of_rivals : outcomes) out.push_back(closest_pair(of_rivals));
  return out;
}

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i)
    out += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return out;
}

}  // namespace

NextExperiment next_experiment(const std::vector<PlantModel>& candidates,
                               const std::vector<std::string>& names, double noise, double largest_force,
                               const RecordedRange& recorded) {
  assert(candidates.size() == names.size() && noise > 0.0);
  NextExperiment out;
  if (candidates.size() < 2) {
    out.sentence = "There are not two explanations to separate.";
    return out;
  }
  const Baseline& baseline = candidates.front().baseline;
  const std::vector<Experiment> menu = scaled_menus(baseline, largest_force, recorded);
  const std::vector<Closest> closest = closest_pairs(menu, candidates, noise, recorded);
  const auto best = std::max_element(closest.begin(), closest.end(),
                                     [](const Closest& a, const Closest& b) { return a.apart < b.apart; });
  out.difference = kMm * best->apart;
  if (best->apart <= noise) {
    out.sentence = fmt::format(
        "No experiment of the menu within the stroke separates {} and {}: their predictions differ by at "
        "most "
        "{:.3g} mm; a reading scatters by {:.3g} mm.",
        names[best->first], names[best->second], out.difference, kMm * noise);
    return out;
  }
  const Experiment& experiment = menu[static_cast<std::size_t>(best - closest.begin())];
  out.name = experiment.name;
  out.separates = names;
  const double ratio = best->apart / noise;
  out.sentence =
      fmt::format("{} There {} differ by {}{:.3g} mm, {} the scatter of a reading.", experiment.instruction,
                  listed(names), names.size() > 2 ? "at least " : "", out.difference,
                  ratio < kFarAbove ? fmt::format("{:.1f} times", ratio) : "far above");
  return out;
}

}  // namespace biopsy::sim::gap
