#include "sim/paper/identification/identify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/config_error.hpp"
#include "robot/common/statistics.hpp"
#include "sim/paper/identification/charge_fit.hpp"

namespace biopsy::sim {
namespace {

using identification::ChargeFit;
using identification::ChargeRecord;

constexpr double kLeastInrush = 1e-3;      // of the decay's charge: less was missed by the monitor
constexpr double kLeastVoltage = 100.0;    // V; below, a stack shows no current
constexpr double kUnexplained = 1.5;       // of the noise
constexpr double kLargestDeviation = 0.5;  // std of ln tau: beyond it, tau is not identifiable

std::vector<ChargeRecord> usable_records(const Dataset& dataset, const std::string& place,
                                         std::vector<std::string>& warnings) {
  std::vector<ChargeRecord> records;
  bool any_current = false;
  for (const RecordedRun& run : dataset.runs) {
    if (run.current.empty()) {
      warnings.push_back(fmt::format("run \"{}\" is left out: it has no column current_uA", run.name));
      continue;
    }
    any_current = true;
    if (run.input.front() != 0.0)
      warnings.push_back(fmt::format(
          "run \"{}\" begins under voltage, and its first row is taken as a step from rest: if the "
          "voltage was on earlier, all values are wrong; record some rows of 0 V first",
          run.name));
    ChargeRecord record = identification::charge_record(run);
    if (record.steps == 0)
      warnings.push_back(fmt::format("run \"{}\" is left out: its voltage never steps", run.name));
    else
      records.push_back(std::move(record));
  }
  if (!any_current)
    throw ConfigError("no run has the column `current_uA`", place,
                      "record the amplifier's current monitor, the mean over each row, beside the voltage");
  double largest = 0.0;
  for (const ChargeRecord& record : records)
    for (const double volts : record.input) largest = std::max(largest, std::abs(volts));
  if (!records.empty() && largest < kLeastVoltage)
    warnings.push_back(fmt::format(
        "no voltage is above {:.3g} V: the column voltage_V is in volts, not in kilovolts", largest));
  if (records.empty())
    throw ConfigError("no run steps its voltage", place,
                      "hold 0 V, step to a constant voltage and hold it for three time constants or more");
  return records;
}

double longest(const std::vector<ChargeRecord>& records) {
  double seconds = 0.0;
  for (const ChargeRecord& record : records) seconds = std::max(seconds, record.after_step);
  return seconds;
}

void require_decay(const ChargeFit& fit, double seconds, const std::string& place) {
  const bool stands_out = fit.regular && fit.decay > kTwoSided95 * std::sqrt(fit.covariance(0, 0));
  if (!stands_out)
    throw ConfigError(
        fmt::format("no decay of the current stands out of its noise of {:.2g} uA", 1e6 * fit.noise), place,
        "step to a higher voltage, hold longer, repeat the step, or average more in the monitor; check the "
        "monitor's sign");
  const double tau = std::exp(fit.log_tau), deviation = std::sqrt(fit.covariance(2, 2));
  if (seconds < tau || deviation > kLargestDeviation)
    throw ConfigError(
        fmt::format(
            "the longest run lasts {:.3g} s after its step, the current decays with a time constant of "
            "about {:.3g} s: too short to separate the decay from an offset",
            seconds, tau),
        place, "hold the voltage for three time constants or more");
}

// Symmetric interval.
CircuitValue linear(double value, double variance, bool known) {
  const double std = std::sqrt(std::max(0.0, variance));
  return {value, std, value - kTwoSided95 * std, value + kTwoSided95 * std, known};
}

// Lognormal interval: positive.
CircuitValue positive(double value, const Eigen::Vector3d& log_gradient, const Eigen::Matrix3d& covariance,
                      bool known) {
  const double std = std::sqrt(std::max(0.0, log_gradient.dot(covariance * log_gradient)));
  return {value, value * std, value * std::exp(-kTwoSided95 * std), value * std::exp(kTwoSided95 * std),
          known};
}

// A = C1 K, B = C1 (1-K), tau. Gradients are of the logarithms with respect to (A, B, ln tau).
void derive(const ChargeFit& fit, IdentifiedCircuit& out) {
  const double A = fit.decay, B = fit.jump, C1 = A + B, tau = std::exp(fit.log_tau);
  const Eigen::Matrix3d& covariance = fit.covariance;
  const bool inrush = B > kLeastInrush * A && B > kTwoSided95 * std::sqrt(covariance(1, 1));
  out.decay_charge = linear(A, covariance(0, 0), true);
  out.jump_charge = linear(B, covariance(1, 1), inrush);
  out.tau = positive(tau, {0.0, 0.0, 1.0}, covariance, true);
  if (!inrush) {
    out.warnings.push_back(
        "the monitor shows no inrush: C1, C2, R and K are not identifiable, only C1 K and tau; record the "
        "monitor's mean over each row");
    return;
  }
  out.C1 = positive(C1, {1.0 / C1, 1.0 / C1, 0.0}, covariance, true);
  out.C2 = positive(C1 * B / A, {1.0 / C1 - 1.0 / A, 1.0 / C1 + 1.0 / B, 0.0}, covariance, true);
  out.R = positive(tau * A / (C1 * C1), {1.0 / A - 2.0 / C1, -2.0 / C1, 1.0}, covariance, true);
  out.K = positive(A / C1, {1.0 / A - 1.0 / C1, -1.0 / C1, 0.0}, covariance, true);
}

// Monitor and fit, one point per stretch; stretches with a step are far above the decay and left out.
FigurePanel panel_of(const ChargeRecord& record, const std::vector<double>& currents) {
  FigurePanel panel{record.name, "time (s)", "current (uA)", 0.0, 1.0, 0.0, 0.0, false, {}};
  FigureCurve seen{"monitor", {}, {}, false, true}, fitted{"C1, C2, R and offset", {}, {}, false, false};
  for (std::size_t i = 0; i < record.parts.size(); ++i) {
    const identification::Stretch& part = record.parts[i];
    if (record.has_step(part)) continue;
    const double from = record.period * static_cast<double>(part.from),
                 seconds = record.period * static_cast<double>(part.to - part.from);
    seen.x.push_back(from + 0.5 * seconds);
    seen.y.push_back(1e6 * part.charge / seconds);
    fitted.x.push_back(seen.x.back());
    fitted.y.push_back(1e6 * currents[i]);
    for (const double y : {seen.y.back(), fitted.y.back()}) {
      panel.y_low = std::min(panel.y_low, 1.05 * y);
      panel.y_high = std::max(panel.y_high, 1.05 * y);
    }
  }
  panel.x_high = record.period * static_cast<double>(record.input.size());
  panel.curves = {seen, fitted};
  return panel;
}

}  // namespace

IdentifiedCircuit identify_circuit(const Dataset& dataset, const std::string& place) {
  IdentifiedCircuit out;
  const std::vector<ChargeRecord> records = usable_records(dataset, place, out.warnings);
  const ChargeFit fit = identification::fit_charges(records);
  require_decay(fit, longest(records), place);
  derive(fit, out);
  out.noise = fit.noise;
  out.misfit = fit.misfit;
  for (std::size_t i = 0; i < records.size(); ++i) {
    out.runs.push_back(
        {records[i].name, records[i].steps, records[i].after_step, fit.offsets[i], fit.offset_stds[i]});
    out.panels.push_back(
        panel_of(records[i], identification::fitted_currents(records[i], fit, fit.offsets[i])));
  }
  if (fit.misfit > kUnexplained)
    out.warnings.push_back(fmt::format(
        "the residual is {:.1f} times the noise: the leakage model does not describe all of this current "
        "(absorption, a leaking cable, a current limit, drift); the intervals are widened accordingly and "
        "may "
        "still be too narrow",
        fit.misfit));
  return out;
}

}  // namespace biopsy::sim
