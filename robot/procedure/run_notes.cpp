#include "robot/procedure/run_notes.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>

#include "robot/procedure/operator.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::robot {
namespace {

bool is_measured(const Measurement& m) {
  return m.laser_valid && m.laser_b_valid &&
         std::abs(std::int64_t{m.depth_um} - m.depth_b_um) <= safety::kDiffer_um;
}

report::Sample sample_of(const CycleSample& cycle, double time_ms) {
  const CycleRecord& tick = cycle.record;
  report::Sample sample;
  sample.time_ms = time_ms;
  sample.setpoint_mm = static_cast<float>(cycle.setpoint.value);
  sample.depth_mm = static_cast<float>(tick.measurement.depth_um * 1e-3);
  sample.tip_mm = static_cast<float>(cycle.truth.tip_mm);
  sample.plate_b_mm = static_cast<float>(cycle.truth.plate_b_mm);
  sample.drive_kV = static_cast<float>(tick.drive_mV * 1e-6);
  sample.envelope_kV = static_cast<float>(tick.supervisor.permit.v_max_mV * 1e-6);
  sample.monitor_kV = static_cast<float>(tick.measurement.monitor_mV * 1e-6);
  sample.current_uA = static_cast<float>(tick.measurement.current_nA * 1e-3);
  sample.mode = tick.supervisor.permit.mode;
  sample.stop = tick.supervisor.permit.stop;
  sample.step = static_cast<std::uint8_t>(tick.supervisor.step);
  sample.locked = tick.measurement.brake_on;
  sample.measured = is_measured(tick.measurement);
  sample.verdict = tick.measurement.verdict;
  return sample;
}

// Layer the tip is in: the deepest one whose surface gave way and that begins ahead of the tip.
std::string layer_at(const Plan& plan, const Truth& truth) {
  std::string name = "outside";
  for (int i = 0; i < truth.layers_entered && i < static_cast<int>(plan.layers.size()); ++i)
    if (truth.tip_mm >= plan.layers[static_cast<std::size_t>(i)].from.value)
      name = plan.layers[static_cast<std::size_t>(i)].name;
  return name;
}

}  // namespace

RunNotes::RunNotes(const PreparedCase& prepared, std::size_t samples_max)
    : plan_(std::get<Plan>(prepared.plan)), samples_max_(samples_max), record_(planned_record(prepared)) {
  record_.samples.reserve(samples_max);  // touched as it fills; growing would copy 100 MB within a tick
}

void RunNotes::note_trip(const CycleRecord& tick, double now_ms) {
  const Mode now = tick.supervisor.permit.mode;
  const bool unasked = now == Mode::Trip || now == Mode::Lock ||
                       (now == Mode::Retract && tick.supervisor.reason != safety::Hazard::None) ||
                       (now == Mode::Hold && tick.supervisor.reason != safety::Hazard::None) ||
                       tick.supervisor.event == safety::Event::HoldTooLong;
  if (now == mode_ || !unasked) return;
  record_.trips.push_back(
      {now_ms * 1e-3, tick.supervisor.permit.stop, cause_of(tick.supervisor, tick.panel_unread_ms)});
}

// From the first tick, on the stage's clock. A stage that was started anew has another clock: its first tick
// follows the last one by a period.
double RunNotes::time_ms(const Measurement& measurement) {
  constexpr std::int64_t kTick_us = std::chrono::microseconds(kTick).count();
  const bool follows = seq_ != 0 && measurement.seq > seq_ && measurement.time_us > last_us_;
  if (!follows) first_us_ = measurement.time_us - (seq_ == 0 ? 0 : last_us_ - first_us_ + kTick_us);
  if (follows) {
    record_.lost_ticks += measurement.seq - seq_ - 1;
    const double gap_ms = static_cast<double>(measurement.time_us - last_us_) * 1e-3;
    const bool late = measurement.time_us - last_us_ != kTick_us;
    if (late) record_.longest_gap_ms = std::max(record_.longest_gap_ms, gap_ms);
  }
  seq_ = measurement.seq;
  last_us_ = measurement.time_us;
  return static_cast<double>(last_us_ - first_us_) * 1e-3;
}

void RunNotes::add(const CycleSample& cycle, const OperatorInputs& inputs) {
  const CycleRecord& seen = cycle.record;
  const double now_ms = time_ms(seen.measurement);
  if (record_.samples.size() < samples_max_)
    record_.samples.push_back(sample_of(cycle, now_ms));
  else
    ++record_.ticks_left_out;
  record_.simulated_s = (now_ms + 1.0) * 1e-3;
  note_trip(seen, now_ms);
  const bool enters_hold = seen.supervisor.permit.mode == Mode::Hold && mode_ == Mode::Active;
  record_.unasked_holds += enters_hold && !seen.supervisor.step_done && inputs.press.held;
  mode_ = seen.supervisor.permit.mode;
  report::StepResult& result = record_.steps[seen.supervisor.step];
  if (seen.supervisor.step_done && !result.reached) {
    result.reached = true;
    result.reached_s = now_ms * 1e-3;
    result.layer_at_tip = layer_at(plan_, cycle.truth);
  }
  reached_ = reached_ || result.reached;
  if (reached_ && (mode_ == Mode::Active || mode_ == Mode::Hold))
    record_.layer_at_tip = layer_at(plan_, cycle.truth);
  note_image(cycle, now_ms, inputs.acquiring);
}

// In a tick without a new measurement nobody knows whether the drive switched. Of a locked needle without
// voltage the next one tells: a change would last, and more such ticks than the supervisor bears end the
// hold.
bool RunNotes::spoils_image(const CycleRecord& tick) {
  flagged_ticks_ = tick.supervisor.image_disturbed ? flagged_ticks_ + 1 : 0;
  return flagged_ticks_ > (is_quiet(tick) ? safety::kStale_ticks : 0);
}

void RunNotes::note_image(const CycleSample& cycle, double now_ms, bool acquiring) {
  const bool begins = acquiring && !imaging_;
  imaging_ = acquiring;
  if (!acquiring) return;
  report::StepResult& result = record_.steps[cycle.record.supervisor.step];
  if (begins) {
    result.image_s = now_ms * 1e-3;
    result.hv_switching_during_image = false;  // what disturbed the image before is no matter of this one
    flagged_ticks_ = 0;
    tip_sum_mm_ = 0.0, tip_count_ = 0;
    tip_low_mm_ = tip_high_mm_ = cycle.truth.tip_mm;
  }
  tip_low_mm_ = std::min(tip_low_mm_, cycle.truth.tip_mm);
  tip_high_mm_ = std::max(tip_high_mm_, cycle.truth.tip_mm);
  result.image_motion_mm = tip_high_mm_ - tip_low_mm_;
  tip_sum_mm_ += cycle.truth.tip_mm;
  ++tip_count_;
  if (spoils_image(cycle.record)) result.hv_switching_during_image = true;
}

Millimetres RunNotes::take_imaged_tip() {
  const auto count = static_cast<double>(std::exchange(tip_count_, 0));
  return Millimetres(std::exchange(tip_sum_mm_, 0.0) / count);
}

}  // namespace biopsy::robot
