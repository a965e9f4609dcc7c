#include "robot/procedure/run_metrics.hpp"

#include <algorithm>
#include <cmath>

#include "safety/types/limits.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::robot {
namespace {

constexpr double kFinalWindow_s = 0.5;  // one period of the square wave

// Running root mean square of errors, and mean of values.
struct Rms {
  double sum = 0.0, mean_sum = 0.0;
  std::size_t count = 0;
  void add(double error, double value) {
    sum += error * error;
    mean_sum += value;
    ++count;
  }
  double value() const { return count == 0 ? report::kUnknown : std::sqrt(sum / static_cast<double>(count)); }
  double mean() const { return count == 0 ? report::kUnknown : mean_sum / static_cast<double>(count); }
};

bool is_driven(const report::Sample& sample) {
  return sample.mode == Mode::Active || sample.mode == Mode::Hold;
}

// Samples of step `index` while it was driven towards or held.
template <class Visit>
void for_step(const report::RunRecord& record, std::size_t index, Visit&& visit) {
  for (const report::Sample& sample : record.samples)
    if (is_driven(sample) && sample.step == index) visit(sample);
}

void measure_stage(const report::RunRecord& record, std::size_t index, report::StepResult& result,
                   Rms& settled_all) {
  const double goal = result.step.depth.value;
  double arrived_s = -1.0;
  Rms settled;
  double deepest = -1e9;
  for_step(record, index, [&](const report::Sample& sample) {
    const double time = sample.time_ms * 1e-3;
    deepest = std::max(deepest, static_cast<double>(sample.depth_mm));
    if (arrived_s < 0.0 && std::abs(sample.setpoint_mm - goal) < 1e-6) arrived_s = time;
    if (arrived_s < 0.0 || time < arrived_s + kSettleTime_s) return;
    settled.add(sample.depth_mm - goal, sample.depth_mm);
    settled_all.add(sample.depth_mm - goal, sample.depth_mm);
  });
  result.rmse_settled_mm = settled.value();
  result.depth_mm = settled.mean();
  if (deepest > -1e9) result.overshoot_mm = std::max(0.0, deepest - goal);
}

// Mean of a depth over the last period in which the needle was driven, of the samples that `tell` it.
template <class Tell>
double final_mean(const report::RunRecord& record, float report::Sample::*depth_mm, Tell&& tell) {
  const auto last = std::find_if(record.samples.rbegin(), record.samples.rend(), is_driven);
  if (last == record.samples.rend()) return report::kUnknown;
  Rms window;
  for (auto sample = last; sample != record.samples.rend() && is_driven(*sample); ++sample) {
    if ((last->time_ms - sample->time_ms) * 1e-3 > kFinalWindow_s) break;
    if (tell(*sample)) window.add(0.0, (*sample).*depth_mm);
  }
  return window.mean();
}

// Where the run ended at 0 V; nothing is said where it did not, or where nothing was driven.
void measure_left(report::RunRecord& record) {
  constexpr std::size_t kWindow =
      100;  // ms: two hundredths of a millimetre of laser noise become two thousandths
  const auto& samples = record.samples;
  if (record.ticks_left_out > 0 || samples.size() < kWindow ||
      std::none_of(samples.begin(), samples.end(), is_driven))
    return;
  Rms window;
  for (auto sample = samples.end() - kWindow; sample != samples.end(); ++sample) {
    if (is_driven(*sample) || sample->drive_kV != 0.0F) return;
    if (sample->measured) window.add(0.0, sample->depth_mm);
  }
  // As the supervisor judges two lasers: more than a fifth of the samples apart are too many.
  record.left_unmeasured = window.count < kWindow * 4 / 5;
  if (!record.left_unmeasured) record.left_depth_mm = window.mean();
}

void measure_limits(report::RunRecord& record) {
  double deepest = 0.0, monitor = 0.0, hold_s = 0.0, held = 0.0, envelope = 0.0;
  double locked_s = 0.0, locked = 0.0, before_ms = 0.0, whole_hold = 0.0, longest_s = 0.0;
  bool has_lock = false, longest_has_lock = false;  // of the present hold, and of the longest
  for (const report::Sample& sample : record.samples) {
    deepest = std::max(deepest, static_cast<double>(sample.depth_mm));
    monitor = std::max(monitor, static_cast<double>(std::abs(sample.monitor_kV)));
    if (sample.envelope_kV > 0.0F && sample.mode == Mode::Active)
      envelope =
          std::max(envelope, static_cast<double>(std::abs(sample.drive_kV) / sample.envelope_kV) * 100.0);
    const double since_s = (sample.time_ms - before_ms) * 1e-3;  // ticks that were lost included
    before_ms = sample.time_ms;
    held = sample.mode == Mode::Hold && !sample.locked ? held + since_s : 0.0;
    // The supervisor counts a locked needle that does not stand still like one that is not locked.
    const bool too_long = std::ranges::any_of(record.trips, [&](const report::Trip& trip) {
      return trip.reason == safety::name_of(safety::Event::HoldTooLong) &&
             std::abs(trip.time_s * 1e3 - sample.time_ms) < 0.5;
    });
    if (too_long) held = whole_hold;
    const bool holds = sample.mode == Mode::Hold;
    whole_hold = holds ? whole_hold + since_s : 0.0;
    has_lock = holds && (has_lock || sample.locked);
    if (whole_hold > longest_s) longest_s = whole_hold, longest_has_lock = has_lock;
    hold_s = std::max(hold_s, held);
    locked = sample.locked ? locked + since_s : 0.0;
    locked_s = std::max(locked_s, locked);
  }
  const Plan& plan = *record.plan;
  record.limits = {
      {"depth of the plan", deepest, plan.limits.depth_max.value, "mm"},
      {"stroke", deepest, limits::kStroke_um * 1e-3, "mm"},
      {"drive voltage", record.peak_kV, limits::kDriveMax_mV * 1e-6, "kV"},
      {"voltage monitor", monitor, limits::kMonitorTrip_mV * 1e-6, "kV"},
      {"step's drive envelope", envelope, 100.0, "%"},
  };
  // By the clock, from the first tick of the hold to its last; what of it was not locked has a limit of its
  // own.
  const double longest_max_s = (longest_has_lock ? limits::kLockedMax_ms : limits::kHoldMax_ms) * 1e-3;
  record.limits.push_back({"longest hold", std::max(longest_s, hold_s), longest_max_s, "s"});
  if (locked_s == 0.0) return;
  record.limits.push_back({"hold without the lock", hold_s, limits::kHoldMax_ms * 1e-3, "s"});
  record.limits.push_back({"needle locked", locked_s, limits::kLockedMax_ms * 1e-3, "s"});
}

}  // namespace

void measure_run(report::RunRecord& record) {
  if (!record.plan) return;
  Rms settled, all;
  record.peak_kV = 0.0;
  for (const report::Sample& sample : record.samples) {
    record.peak_kV = std::max(record.peak_kV, static_cast<double>(std::abs(sample.drive_kV)));
    if (is_driven(sample)) all.add(sample.depth_mm - sample.setpoint_mm, sample.depth_mm);
  }
  double overshoot = report::kUnknown;
  for (std::size_t i = 0; i < record.steps.size(); ++i) {
    report::StepResult& result = record.steps[i];
    measure_stage(record, i, result, settled);
    if (!std::isnan(result.overshoot_mm)) overshoot = std::fmax(overshoot, result.overshoot_mm);
    if (!result.check || !result.check->tip_found) continue;
    record.image_depth_mm = result.check->depth.value;
    record.image_depth_sigma_mm = result.check->sigma.value;
  }
  record.rmse_settled_mm = settled.value();
  record.rmse_all_mm = all.value();
  record.overshoot_mm = overshoot;
  record.final_depth_mm =
      final_mean(record, &report::Sample::depth_mm, [](const auto& sample) { return sample.measured; });
  measure_left(record);
  if (record.simulated) {
    record.true_final_depth_mm =
        final_mean(record, &report::Sample::tip_mm, [](const auto&) { return true; });
    for (const report::Sample& sample : record.samples)
      record.true_depth_max_mm = std::fmax(record.true_depth_max_mm, static_cast<double>(sample.tip_mm));
  }
  measure_limits(record);
}

}  // namespace biopsy::robot
