#include "safety/monitors/depth_monitor.hpp"

#include <algorithm>

#include "safety/types/limits.hpp"
#include "safety/monitors/debounce.hpp"

namespace biopsy::safety {
namespace {

constexpr std::int32_t magnitude(std::int32_t drive_mV) {
  const std::int32_t bounded = std::clamp(drive_mV, -limits::kDriveMax_mV, limits::kDriveMax_mV);
  return bounded < 0 ? -bounded : bounded;
}

// Where the needle would come to rest if the stop began now: d + v T + v^2 / 2a.
std::int64_t stopping_depth_um(std::int32_t depth_um, std::int64_t velocity_um_per_s) {
  const std::int64_t v = std::max<std::int64_t>(velocity_um_per_s, 0);
  return depth_um + v * kReaction_us / 1'000'000 + v * v / (2 * kDecel_um_per_s2);
}

HazardSet look_at_depth(const PlanFacts& plan, DepthWatch& watch, const Permit& permit,
                        std::int32_t depth_um) {
  const std::int64_t stopping = stopping_depth_um(depth_um, watch.history.velocity_um_per_s());
  const std::int64_t planned = plan.depth_max_um;
  const bool hard =
      depth_um > planned + limits::kDepthMargin_um || stopping > planned + limits::kDepthHard_um;
  const bool stage = permit.mode == Mode::Active && stopping > permit.depth_max_um;
  watch.hard_ticks = counted(watch.hard_ticks, hard, kDepth_ticks);
  watch.over_ticks = counted(watch.over_ticks, stopping > planned, kDepth_ticks);
  watch.stage_ticks = counted(watch.stage_ticks, stage, kDepth_ticks);
  return when(watch.hard_ticks >= kDepth_ticks, Hazard::HardOverDepth) |
         when(watch.over_ticks >= kDepth_ticks, Hazard::OverDepth) |
         when(watch.stage_ticks >= kDepth_ticks, Hazard::StageDepth);
}

HazardSet look_at_motion(DepthWatch& watch, Mode mode) {
  const bool lifted =
      mode == Mode::Active || mode == Mode::Hold;  // elsewhere gravity is meant to withdraw it
  watch.pop_ticks = counted(watch.pop_ticks, watch.history.advance_um() > kPopThrough_um, kDepth_ticks);
  const bool dropping = watch.history.velocity_um_per_s() < -kFastDrop_um_per_s;
  return when(lifted && watch.pop_ticks >= kDepth_ticks, Hazard::PopThrough) |
         when(lifted && dropping, Hazard::FastDrop);
}

HazardSet look_at_code(DepthWatch& watch, const Measurement& m) {
  const std::int32_t drive = magnitude(m.command_mV);
  const bool same = m.laser_code == watch.code;
  watch.same_code_ticks = counted(watch.same_code_ticks, same, kFrozen_ticks);
  watch.frozen_low_mV = same ? std::min(watch.frozen_low_mV, drive) : drive;
  watch.frozen_high_mV = same ? std::max(watch.frozen_high_mV, drive) : drive;
  watch.code = m.laser_code;
  const bool moved = watch.frozen_high_mV - watch.frozen_low_mV > kFrozenMove_mV;
  return when(moved && watch.same_code_ticks >= kFrozen_ticks, Hazard::SensorFrozen);
}

HazardSet look_at_plausibility(const PlanFacts& plan, DepthWatch& watch, std::int32_t depth_um) {
  const std::int32_t low_mV = watch.window.lowest_mV(), high_mV = watch.window.highest_mV();
  if (low_mV != watch.range_low_mV || high_mV != watch.range_high_mV || plan.plan_tag != watch.range_tag) {
    watch.range = plausible_depth(plan, low_mV, high_mV);
    watch.range_low_mV = low_mV, watch.range_high_mV = high_mV, watch.range_tag = plan.plan_tag;
  }
  const bool outside =
      depth_um < watch.range.low_um - kImplausible_um || depth_um > watch.range.high_um + kImplausible_um;
  watch.implausible_ticks = counted(watch.implausible_ticks, outside, kImplausible_ticks);
  return when(watch.implausible_ticks >= kImplausible_ticks, Hazard::OffsetOrScale);
}

// A needle goes back when the drive was lowered. One that seems to go back without is the laser's zero
// walking off, which the loop would follow into the tissue. (On the bench DC decays, and is measured.)
HazardSet look_at_return(const PlanFacts& plan, DepthWatch& watch, Mode mode, std::int32_t drive_mV) {
  const bool lifted = mode == Mode::Active || mode == Mode::Hold;
  const bool lowered = drive_mV < watch.window.highest_mV() - kLowered_mV;
  const std::int32_t surely_um = watch.history.surely_um();
  watch.deepest_um = !lifted || lowered ? surely_um : std::max(watch.deepest_um, surely_um);
  const bool sunk = is_for_patient(plan) && watch.deepest_um - watch.history.latest_um() > kSunk_um;
  watch.sunk_ticks = counted(watch.sunk_ticks, sunk, kSunk_ticks);
  return when(watch.sunk_ticks >= kSunk_ticks, Hazard::OffsetOrScale);
}

void look_at_valid(const PlanFacts& plan, DepthWatch& watch, const Observation& seen, bool zero_volts) {
  const Measurement& m = seen.measurement;
  const std::int32_t depth_um = std::clamp(m.depth_um, -1'000'000, 1'000'000);  // no sensor reaches a metre
  if (watch.dropout_ticks >= kDropout_ticks) watch.history.fill(depth_um);
  watch.history.push(depth_um);
  watch.needle_home = depth_um < limits::kReturned_um;
  watch.not_back_ticks = counted(watch.not_back_ticks, zero_volts && !watch.needle_home, kNotBack_ticks);
  watch.found = look_at_depth(plan, watch, seen.permit, depth_um);
  watch.found |= look_at_motion(watch, seen.permit.mode);
  watch.found |= look_at_return(plan, watch, seen.permit.mode, magnitude(m.command_mV));
  watch.found |= look_at_code(watch, m);
  watch.found |= look_at_plausibility(plan, watch, depth_um);
  watch.found |= when(watch.not_back_ticks >= kNotBack_ticks, Hazard::NeedleNotBack);
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

DepthFindings look(const PlanFacts& plan, DepthWatch& watch, const Observation& seen, bool fresh,
                   bool zero_volts) {
  const Measurement& m = seen.measurement;
  if (fresh) {
    watch.window.push(magnitude(m.command_mV));
    if (m.laser_valid) look_at_valid(plan, watch, seen, zero_volts);
    watch.dropout_ticks = counted(watch.dropout_ticks, !m.laser_valid, kDropout_ticks);
  }
  const bool dropout = watch.dropout_ticks >= kDropout_ticks;
  return {watch.found | when(dropout, Hazard::LaserDropout), watch.needle_home && !dropout};
}

}  // namespace biopsy::safety
