// Runs of the plant under given voltages, with the amplifier's monitor, its noise and offset.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "sim/plant/dataset.hpp"
#include "sim/plant/plant.hpp"
#include "sim/plant/seeded_noise.hpp"

namespace biopsy::sim {

struct Monitor {
  double noise = 0.0, offset = 0.0;  // A
  std::uint64_t seed = 1;
  bool mean = true;  // over each row; otherwise the current at the row's instant
};

// Commanded voltage at a time, V.
using Program = std::function<double(double)>;

inline Program step_at(double at, double volts) {
  return [=](double t) { return t >= at - 1e-9 ? volts : 0.0; };
}

inline RecordedRun monitored_run(const PlantModel& model, const Program& volts, double seconds, double period,
                                 const Monitor& monitor) {
  RecordedRun run;
  run.name = "run";
  run.file = "run.csv";
  run.weight = model.weight;
  run.period = period;
  PlantState state = at_rest(model);
  const auto rows = static_cast<std::size_t>(std::lround(seconds / period));
  double current_now = 0.0;
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = static_cast<double>(k) * period;
    run.time.push_back(t);
    run.input.push_back(volts(t));
    run.displacement.push_back(state.motion.x);
    run.current.push_back(current_now + monitor.offset + monitor.noise * normals(monitor.seed, k).first);
    run.external_force.push_back(0.0);
    state = step(model, state, {.voltage = run.input.back()}, Seconds(period));
    current_now = monitor.mean ? state.charge / period : current(model, state);
  }
  return run;
}

// The same by eq. (2) alone, where many runs are needed: charge = C1 (change of u_i - change of u_o).
inline RecordedRun circuit_run(double C1, double K, double tau, const Program& volts, double seconds,
                               double period, const Monitor& monitor) {
  RecordedRun run;
  run.name = "run";
  run.period = period;
  const auto rows = static_cast<std::size_t>(std::lround(seconds / period));
  double u_i = 0.0, u_o = 0.0, mean = 0.0;
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = static_cast<double>(k) * period, u = volts(t);
    run.time.push_back(t);
    run.input.push_back(u);
    run.displacement.push_back(0.0);
    run.current.push_back(mean + monitor.offset + monitor.noise * normals(monitor.seed, k).first);
    const double across = u_i - u_o;
    u_o = (u_o + K * (u - u_i)) * std::exp(-period / tau);
    u_i = u;
    mean = C1 * (u_i - u_o - across) / period;
  }
  return run;
}

}  // namespace biopsy::sim
