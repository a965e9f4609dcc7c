#include "tests/bench/gap_balance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/plant/simulate.hpp"

namespace biopsy::bench {
namespace {

using sim::Drive;

constexpr double kHalfLine = 0.015;   // s, readings on either side that give the speed
constexpr double kHalfWindow = 0.06;  // s: a window spans less than the stage's period of 0.15 s
constexpr double kStandstill = 3e-4;  // m/s: slower, the sign of the speed is noise
constexpr double kSlow = 2e-3;        // m/s, where a Stribeck curve falls
constexpr double kDeep = 2.5e-3;      // m, of 3.6: where a stop would be
constexpr double kSurface = 1e-3;     // m, where tissue would begin
constexpr double kHigh = 2000.0;      // V, where an amplifier would saturate

double slope(const std::vector<double>& readings, std::size_t row, std::size_t half, double period) {
  const std::size_t from = row < half ? 0 : row - half, to = std::min(readings.size() - 1, row + half);
  const double middle = 0.5 * static_cast<double>(from + to);
  double rise = 0.0, run = 0.0;
  for (std::size_t i = from; i <= to; ++i) {
    const double at = static_cast<double>(i) - middle;
    rise += at * readings[i], run += at * at;
  }
  return rise / run / period;
}

double direction(const Sample& s) {
  return std::tanh(s.v / kStandstill);
}

// (1 - s^2)^4 over the window and its derivatives; sums to 1.
struct Weights {
  std::size_t half;
  std::array<std::vector<double>, 3> of_order;
};

Weights weights(double period) {
  Weights out{std::max<std::size_t>(3, static_cast<std::size_t>(kHalfWindow / period)), {}};
  const double width = static_cast<double>(out.half) * period;
  double sum = 0.0;
  for (std::size_t i = 0; i <= 2 * out.half; ++i) {
    const double s = static_cast<double>(i) / static_cast<double>(out.half) - 1.0, a = 1.0 - s * s;
    out.of_order[0].push_back(std::pow(a, 4));
    out.of_order[1].push_back(8.0 * s * std::pow(a, 3) / width);  // integrated by parts: the sign turns
    out.of_order[2].push_back((48.0 * s * s * a * a - 8.0 * std::pow(a, 3)) / (width * width));
    sum += std::pow(a, 4);
  }
  for (auto& order : out.of_order)
    for (double& value : order) value /= sum;
  return out;
}

double average(const Weights& w, const SampledRun& run, std::size_t middle, int order,
               const std::function<double(const Sample&)>& of) {
  const auto& weight = w.of_order[static_cast<std::size_t>(order)];
  double sum = 0.0;
  for (std::size_t i = 0; i < weight.size(); ++i) sum += weight[i] * of(run.samples[middle - w.half + i]);
  return sum;
}

double left_over(const Weights& w, const SampledRun& run, std::size_t middle, const sim::Baseline& b) {
  const auto stretch = [](const Sample& s) { return s.stretch(); };
  const auto x = [](const Sample& s) { return s.x; };
  const auto outside = [&](const Sample& s) { return b.drive == Drive::Stack ? s.push : s.push - s.u; };
  const double damper = b.drive == Drive::Stack ? b.c_k * average(w, run, middle, 1, stretch) : 0.0;
  return run.samples[middle].mass * average(w, run, middle, 2, x) -
         b.k * average(w, run, middle, 0, stretch) - damper + b.c_s * average(w, run, middle, 1, x) +
         average(w, run, middle, 0, outside);
}

}  // namespace

SampledRun sampled(const sim::RecordedRun& run, const sim::PlantModel& model) {
  const bool stack = model.baseline.drive == Drive::Stack;
  const bool measured = !run.plate_b.empty();
  const sim::RecordedRun said = stack && !measured ? sim::simulate(model, run) : run;
  const auto half = std::max<std::size_t>(1, static_cast<std::size_t>(kHalfLine / run.period));
  sim::PlantModel loaded = model;
  loaded.weight = run.weight;
  SampledRun out{run.period, {}};
  double pull = 0.0, before = 0.0;
  for (std::size_t i = 0; i < run.time.size(); ++i) {
    pull += model.baseline.K * (run.input[i] - before);
    before = run.input[i];
    out.samples.push_back({run.time[i], run.displacement[i], slope(run.displacement, i, half, run.period),
                           run.input[i], stack ? said.plate_b[i] : 0.0, run.external_force[i],
                           loaded.mass_A(), pull});
    pull *= std::exp(-run.period / model.baseline.tau);
  }
  return out;
}

std::vector<Column> dictionary(const sim::Baseline& b, double frequency) {
  const double w = 2.0 * std::numbers::pi * frequency;
  const auto x = [](const Sample& s) { return s.x; };
  const auto stretch = [](const Sample& s) { return s.stretch(); };
  std::vector<Column> out{
      {"external_force", "force_N", -1, [](const Sample&) { return 1.0; }},
      {"coulomb_friction", "force_N", -1, direction},
      {"stribeck_friction", "breakaway_N", -1,
       [](const Sample& s) { return direction(s) * std::exp(-std::pow(s.v / kSlow, 2)); }},
      {"c_s", "", -1, x, 1},
      {"quadratic_damping", "coefficient_N_s2_per_m2", -1,
       [](const Sample& s) { return s.v * std::abs(s.v); }},
      {"k", "", 1, stretch},
      {"spring_hardening", "cubic_N_per_mm3", 1e-9, [](const Sample& s) { return std::pow(s.stretch(), 3); }},
      {"added_mass", "mass_g", 1e3, x, 2},
      {"periodic_disturbance", "force_N", 1, [w](const Sample& s) { return std::sin(w * s.t); }},
      {"periodic_disturbance", "force_N", 1, [w](const Sample& s) { return std::cos(w * s.t); }},
      {"end_stop", "", 1, [](const Sample& s) { return std::max(0.0, s.x - kDeep); }},
      {"shaft_friction", "coulomb_N_per_mm", -1e-3, [](const Sample& s) { return direction(s) * s.x; }},
      {"sensor_drift", "", 1, [](const Sample& s) { return s.t; }}};
  if (b.drive == Drive::Force) return out;
  out.push_back({"layer_puncture", "", 1, [](const Sample& s) { return s.x > kSurface ? 1.0 : 0.0; }});
  out.push_back({"sensor_scale", "", 1, x});
  out.push_back({"K", "", 1, [](const Sample& s) { return s.pull * s.pull; }});
  out.push_back({"polarity_asymmetry", "", 1, [](const Sample& s) { return s.pull * std::abs(s.pull); }});
  out.push_back(
      {"voltage_saturation", "", 1, [](const Sample& s) { return std::max(0.0, std::abs(s.u) - kHigh); }});
  out.push_back({"charge_retention", "", 1, [](const Sample& s) { return std::copysign(s.pull, s.u); }});
  return out;
}

Balance balance(const std::vector<SampledRun>& runs, const std::vector<Column>& columns,
                const sim::Baseline& b) {
  std::vector<std::pair<const SampledRun*, std::size_t>> windows;
  for (const SampledRun& run : runs) {
    const std::size_t half = weights(run.period).half;
    for (std::size_t i = half; i + half < run.samples.size(); i += half) windows.emplace_back(&run, i);
  }
  const auto rows = static_cast<Eigen::Index>(windows.size());
  Balance out{
      {rows, static_cast<Eigen::Index>(columns.size())}, Eigen::VectorXd(rows), Eigen::VectorXd(rows)};
  for (Eigen::Index row = 0; row < rows; ++row) {
    const auto& [run, middle] = windows[static_cast<std::size_t>(row)];
    const Weights w = weights(run->period);
    for (std::size_t i = 0; i < columns.size(); ++i)
      out.columns(row, static_cast<Eigen::Index>(i)) =
          average(w, *run, middle, columns[i].order, columns[i].of);
    out.left_over(row) = left_over(w, *run, middle, b);
    out.time(row) = run->samples[middle].t;
  }
  return out;
}

}  // namespace biopsy::bench
