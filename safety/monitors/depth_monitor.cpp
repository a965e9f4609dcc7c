#include "safety/monitors/depth_monitor.hpp"

#include <algorithm>
#include <cstdlib>

#include "safety/monitors/clock_step.hpp"
#include "safety/monitors/debounce.hpp"
#include "safety/types/limits.hpp"
#include "safety/types/magnitude.hpp"

namespace biopsy::safety {
namespace {

std::int64_t squared_volts(std::int32_t drive_mV) {
  const std::int64_t volts = drive_magnitude_mV(drive_mV) / 1'000;
  return volts * volts;
}

// Where the needle would come to rest if the stop began now: d + v T + v^2 / 2a.
std::int64_t stopping_depth_um(std::int32_t depth_um, std::int64_t velocity_um_per_s) {
  const std::int64_t v = std::max<std::int64_t>(velocity_um_per_s, 0);
  return depth_um + v * kReaction_us / 1'000'000 + v * v / (2 * kDecel_um_per_s2);
}

HazardSet check_depth(const PlanFacts& plan, DepthMonitor& monitor, const Permit& permit,
                      std::int32_t depth_um) {
  const std::int64_t stopping = stopping_depth_um(depth_um, monitor.history.velocity_um_per_s());
  const std::int64_t planned = plan.depth_max_um;
  const bool hard =
      depth_um > planned + limits::kDepthMargin_um || stopping > planned + limits::kDepthHard_um;
  const bool step = permit.mode == Mode::Active && stopping > permit.depth_max_um;
  monitor.hard_ticks = debounced(monitor.hard_ticks, hard, kDepth_ticks);
  monitor.over_ticks = debounced(monitor.over_ticks, stopping > planned, kDepth_ticks);
  monitor.step_ticks = debounced(monitor.step_ticks, step, kDepth_ticks);
  return when(monitor.hard_ticks >= kDepth_ticks, Hazard::HardOverDepth) |
         when(monitor.over_ticks >= kDepth_ticks, Hazard::OverDepth) |
         when(monitor.step_ticks >= kDepth_ticks, Hazard::StepDepth);
}

HazardSet check_motion(DepthMonitor& monitor, Mode mode) {
  const bool lifted =
      mode == Mode::Active || mode == Mode::Hold;  // elsewhere gravity is meant to withdraw it
  monitor.pop_ticks =
      debounced(monitor.pop_ticks, monitor.history.advance_um() > kPopThrough_um, kDepth_ticks);
  const bool dropping = monitor.history.velocity_um_per_s() < -kFastDrop_um_per_s;
  return when(lifted && monitor.pop_ticks >= kDepth_ticks, Hazard::PopThrough) |
         when(lifted && dropping, Hazard::FastDrop);
}

HazardSet check_code(DepthMonitor& monitor, const Measurement& m) {
  const std::int32_t drive = drive_magnitude_mV(m.command_mV);
  const bool same = m.laser_code == monitor.code;
  monitor.same_code_ticks = debounced(monitor.same_code_ticks, same, kFrozen_ticks);
  monitor.frozen_low_mV = same ? std::min(monitor.frozen_low_mV, drive) : drive;
  monitor.frozen_high_mV = same ? std::max(monitor.frozen_high_mV, drive) : drive;
  monitor.code = m.laser_code;
  const bool moved = monitor.frozen_high_mV - monitor.frozen_low_mV > kFrozenMove_mV;
  return when(moved && monitor.same_code_ticks >= kFrozen_ticks, Hazard::SensorFrozen);
}

// Not of a locked needle: the drive says nothing about where it is.
HazardSet check_plausibility(const PlanFacts& plan, DepthMonitor& monitor, std::int32_t depth_um,
                             bool locked) {
  const std::int32_t low_mV = monitor.window.lowest_mV(), high_mV = monitor.window.highest_mV();
  if (low_mV != monitor.range_low_mV || high_mV != monitor.range_high_mV ||
      plan.plan_tag != monitor.range_tag) {
    monitor.range = plausible_depth(plan, low_mV, high_mV);
    monitor.rest_pull_V2 = kLiftPulls * squared_volts(lifting_drive_mV(plan));
    monitor.range_low_mV = low_mV, monitor.range_high_mV = high_mV, monitor.range_tag = plan.plan_tag;
  }
  const bool outside =
      depth_um < monitor.range.low_um - kImplausible_um || depth_um > monitor.range.high_um + kImplausible_um;
  monitor.implausible_ticks = debounced(monitor.implausible_ticks, outside && !locked, kImplausible_ticks);
  return when(monitor.implausible_ticks >= kImplausible_ticks, Hazard::OffsetOrScale);
}

// The brake has the needle only where the permit lets it: one that grips unasked must not earn a permit by
// it.
bool is_locked(const SupervisorInputs& seen) {
  const Mode mode = seen.permit.mode;
  return seen.measurement.brake_on && seen.permit.brake && (mode == Mode::Active || mode == Mode::Hold);
}

// Whether it stays where the brake took it.
void watch_brake(DepthMonitor& monitor, bool locked) {
  const std::int32_t mean_um = monitor.history.mean_um();
  if (!locked) monitor.locked_um = mean_um, monitor.slip_ticks = 0;
  const std::int32_t moved_um = std::abs(mean_um - monitor.locked_um);
  const bool slips = moved_um > limits::kStill_um - kStillNoise_um;
  // Once it has slipped, the image shows it elsewhere, wherever it is later.
  if (monitor.slip_ticks < kSlip_ticks)
    monitor.slip_ticks = debounced(monitor.slip_ticks, slips, kSlip_ticks);
  monitor.settling_ticks = locked ? kSettling_ticks : std::max(monitor.settling_ticks - 1, 0);
}

// Pull that rises and rises while the needle seems to stand still moves a needle that is not seen, unless the
// brake holds it: it is lifted past what carried it before it is let go.
HazardSet check_work(const PlanFacts& plan, DepthMonitor& monitor, Mode mode, std::int32_t drive_mV,
                     bool locked) {
  const bool lifted = mode == Mode::Active || mode == Mode::Hold;
  const std::int32_t mean_um = monitor.history.mean_um();
  const std::int64_t pull_V2 = squared_volts(drive_mV);
  if (!lifted) monitor.advanced_um = mean_um, monitor.pull_V2 = monitor.rest_pull_V2;
  if (mean_um > monitor.advanced_um + kAdvanced_um) {
    monitor.advanced_um = mean_um;
    monitor.pull_V2 = std::max(monitor.rest_pull_V2, pull_V2);
  }
  const bool idle = lifted && !locked && is_for_patient(plan) && pull_V2 > monitor.pull_V2 + kIdlePull_V2;
  monitor.idle_ticks = debounced(monitor.idle_ticks, idle, kIdle_ticks);
  return when(monitor.idle_ticks >= kIdle_ticks, Hazard::SensorFrozen);
}

// A needle goes back when the drive was lowered, and goes on for seconds where the films creep, as long as
// nothing lifts it again. One that seems to go back without is the laser's zero walking off, which the loop
// would follow into the tissue. (On the bench DC decays, and is measured.) One that the brake has just let go
// of settles where the stack carries it now.
HazardSet check_return(const PlanFacts& plan, DepthMonitor& monitor, Mode mode, std::int32_t drive_mV,
                       bool locked) {
  const bool lifted = mode == Mode::Active || mode == Mode::Hold;
  const bool lowered = drive_mV < monitor.window.highest_mV() - kLowered_mV;
  monitor.creeping_ticks = std::max(monitor.creeping_ticks - 1, 0);
  if (drive_mV > monitor.lowered_mV + kLowered_mV) monitor.creeping_ticks = 0;
  if (lowered) monitor.lowered_mV = drive_mV, monitor.creeping_ticks = kCreeping_ticks;
  const bool settling = !locked && monitor.settling_ticks > 0;
  const bool may_sink = !lifted || monitor.creeping_ticks > 0 || settling;
  const std::int32_t surely_um = monitor.history.surely_um();
  monitor.deepest_um = may_sink ? surely_um : std::max(monitor.deepest_um, surely_um);
  const bool sunk = is_for_patient(plan) && monitor.deepest_um - monitor.history.latest_um() > kSunk_um;
  monitor.sunk_ticks = debounced(monitor.sunk_ticks, sunk, kSunk_ticks);
  return when(monitor.sunk_ticks >= kSunk_ticks, Hazard::OffsetOrScale);
}

void check_valid(const PlanFacts& plan, DepthMonitor& monitor, const SupervisorInputs& seen,
                 bool zero_volts) {
  const Measurement& m = seen.measurement;
  const std::int32_t depth_um = std::clamp(m.depth_um, -1'000'000, 1'000'000);  // no sensor reaches a metre
  if (monitor.dropout_score >= kDropoutTrip) monitor.history.fill(depth_um);
  monitor.history.push(depth_um);
  monitor.needle_home = depth_um < limits::kReturned_um;
  monitor.needle_back = std::abs(monitor.history.mean_um()) <= limits::kBack_um;
  const bool locked = is_locked(seen);
  watch_brake(monitor, locked);
  monitor.not_back_ticks =
      debounced(monitor.not_back_ticks, zero_volts && !monitor.needle_home && !locked, kNotBack_ticks);
  monitor.found = check_depth(plan, monitor, seen.permit, depth_um);
  monitor.found |= check_motion(monitor, seen.permit.mode);
  monitor.found |= check_return(plan, monitor, seen.permit.mode, drive_magnitude_mV(m.command_mV), locked);
  monitor.found |= check_code(monitor, m);
  monitor.found |= check_plausibility(plan, monitor, depth_um, locked);
  monitor.found |= check_work(plan, monitor, seen.permit.mode, m.command_mV, locked);
  monitor.found |= when(monitor.not_back_ticks >= kNotBack_ticks, Hazard::NeedleNotBack);
}

}  // namespace

void DepthHistory::fill(std::int32_t depth) {
  depth_um.fill(depth);
  newest = before = 8 * depth;
}

void DepthHistory::push(std::int32_t depth) {
  const auto back = [this](std::uint32_t ticks) { return depth_um[(next - ticks) % 32]; };
  newest += depth - back(8);
  before += back(8) - back(16);
  depth_um[next % 32] = depth;
  ++next;
}

void DriveWindow::push(std::int32_t drive_mV) {
  if (ticks == 0)
    low_mV[static_cast<std::size_t>(block)] = high_mV[static_cast<std::size_t>(block)] = drive_mV;
  std::int32_t& low = low_mV[static_cast<std::size_t>(block)];
  std::int32_t& high = high_mV[static_cast<std::size_t>(block)];
  low = std::min(low, drive_mV);
  high = std::max(high, drive_mV);
  if (++ticks < kBlock_ticks) return;
  ticks = 0;
  block = (block + 1) % kBlocks;
  past_low_mV = *std::min_element(low_mV.begin(), low_mV.end());
  past_high_mV = *std::max_element(high_mV.begin(), high_mV.end());
}

std::int32_t DriveWindow::lowest_mV() const {
  return ticks == 0 ? past_low_mV : std::min(past_low_mV, low_mV[static_cast<std::size_t>(block)]);
}

std::int32_t DriveWindow::highest_mV() const {
  return ticks == 0 ? past_high_mV : std::max(past_high_mV, high_mV[static_cast<std::size_t>(block)]);
}

DepthFindings update(const PlanFacts& plan, DepthMonitor& monitor, const SupervisorInputs& seen,
                     const LinkFindings& link, bool zero_volts) {
  const Measurement& m = seen.measurement;
  if (link.fresh) {
    monitor.window.push(drive_magnitude_mV(m.command_mV));
    if (m.laser_valid) check_valid(plan, monitor, seen, zero_volts);
    monitor.dropout_score = accumulated(monitor.dropout_score, !m.laser_valid, kComes_goes, kDropout_ticks);
  }
  const bool dropout = monitor.dropout_score >= kDropoutTrip;
  DepthFindings findings;
  findings.found = monitor.found | when(dropout, Hazard::LaserDropout);
  findings.needle_home = monitor.needle_home && !dropout;
  findings.needle_back = monitor.needle_back && !dropout;
  findings.locked = is_locked(seen);
  monitor.locked_ms =
      findings.locked ? later_ms(monitor.locked_ms, link.elapsed_ms, limits::kLockedMax_ms) : 0;
  findings.still = findings.locked && !dropout && monitor.slip_ticks < kSlip_ticks &&
                   monitor.locked_ms < limits::kLockedMax_ms;
  return findings;
}

}  // namespace biopsy::safety
