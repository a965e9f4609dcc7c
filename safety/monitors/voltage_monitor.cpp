#include "safety/monitors/voltage_monitor.hpp"

#include <algorithm>
#include <cstdlib>

#include "safety/types/limits.hpp"
#include "safety/monitors/debounce.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::safety {
namespace {

constexpr std::int64_t magnitude(std::int32_t value) {
  return value < 0 ? -std::int64_t{value} : value;
}

HazardSet look_at_voltage(DriveWatch& watch, const Measurement& m) {
  const std::int64_t larger = std::max(magnitude(m.command_mV), magnitude(watch.command_mV));
  const std::int64_t tolerance = std::max<std::int64_t>(kDisagreeFloor_mV, larger * kDisagree_percent / 100);
  // The monitor may lag by one tick: anything between the last two commands is right.
  const std::int64_t lowest = std::min(m.command_mV, watch.command_mV) - tolerance;
  const std::int64_t highest = std::max(m.command_mV, watch.command_mV) + tolerance;
  const bool differs = m.hv_enabled && (m.monitor_mV < lowest || m.monitor_mV > highest);
  const bool over = magnitude(m.monitor_mV) > limits::kMonitorTrip_mV;
  watch.disagree_ticks = counted(watch.disagree_ticks, differs, kDisagree_ticks);
  watch.over_ticks = counted(watch.over_ticks, over, kOverVoltage_ticks);
  return when(watch.disagree_ticks >= kDisagree_ticks, Hazard::MonitorDisagrees) |
         when(watch.over_ticks >= kOverVoltage_ticks, Hazard::OverVoltage);
}

HazardSet look_at_current(DriveWatch& watch, const Measurement& m) {
  const std::int64_t change = std::abs(std::int64_t{m.command_mV} - watch.command_mV);
  const std::int64_t largest = std::max({change, watch.change_mV[0], watch.change_mV[1]});
  const bool excess = magnitude(m.current_nA) > kCapacitive_nA_per_mV * largest + kArcMargin_nA;
  watch.change_mV = {change, watch.change_mV[0]};
  watch.arc_ticks = counted(watch.arc_ticks, excess, kArc_ticks);
  return when(watch.arc_ticks >= kArc_ticks, Hazard::Arc);
}

HazardSet look_at_obedience(DriveWatch& watch, const Measurement& m, const Permit& permit) {
  const bool beyond = magnitude(m.command_mV) > std::int64_t{permit.v_max_mV} + kDisobey_mV;
  watch.disobey_ticks =
      counted(watch.disobey_ticks, beyond || m.hv_enabled != permit.hv_enable, kDisobey_ticks);
  return when(watch.disobey_ticks >= kDisobey_ticks, Hazard::DriverDisobeys);
}

// Zero needs three quiet samples, and is lost at once by a command, by the monitor only after three.
HazardSet look_at_zero(DriveWatch& watch, const Measurement& m, Mode mode) {
  const bool present = magnitude(m.monitor_mV) > limits::kZeroVolt_mV;
  const bool commanded = magnitude(m.command_mV) > limits::kZeroVolt_mV;
  watch.zero_ticks = counted(watch.zero_ticks, !present && !commanded, kZero_ticks);
  watch.nonzero_ticks = counted(watch.nonzero_ticks, present, kZero_ticks);
  if (watch.zero_ticks >= kZero_ticks) watch.zero_volts = true;
  if (commanded || watch.nonzero_ticks >= kZero_ticks) watch.zero_volts = false;
  watch.off_ticks = counted(watch.off_ticks, !is_hot(mode), kResidual_ticks);
  return when(watch.off_ticks >= kResidual_ticks && watch.nonzero_ticks >= kZero_ticks,
              Hazard::ResidualCharge);
}

void forget_wave(DriveWatch& watch) {
  watch.flips = 0;
  watch.polarity = 0;
  watch.wrong_frequency = false;
}

void note_flip(DriveWatch& watch, std::int32_t half_period) {
  if (watch.flips == 4) {  // four half-periods lie between the oldest of these and now
    const std::int64_t two_periods = kTwoPeriods_half_periods * half_period;
    const std::int64_t off = watch.tick - watch.flip_tick[3] - two_periods;
    watch.wrong_frequency = kOffOneIn * std::abs(off) > two_periods;
  }
  watch.flip_tick = {watch.tick, watch.flip_tick[0], watch.flip_tick[1], watch.flip_tick[2]};
  watch.flips = std::min(watch.flips + 1, 4);
}

// Already longer than any sound wave takes, since one of the last flips or since the wave began.
bool is_too_slow(const DriveWatch& watch) {
  constexpr std::int64_t kAllowed = kTwoPeriods_half_periods * kHalfPeriod_ticks / kOffOneIn;
  const std::int32_t oldest = std::clamp(watch.flips, 0, 3);  // the begin, while there were fewer than four
  for (std::int32_t i = 0; i <= oldest; ++i) {
    const std::int64_t ago = watch.tick - watch.flip_tick[static_cast<std::size_t>(i)];
    if (ago - std::int64_t{i + 1} * kHalfPeriod_ticks > kAllowed) return true;
  }
  return false;
}

// A slow wave needs as many of its own periods to show its balance.
std::int64_t forgetting_ticks(std::int32_t half_period) {
  return kForget_ticks * std::max(half_period, kHalfPeriod_ticks) / kHalfPeriod_ticks;
}

HazardSet look_at_wave(const PlanFacts& plan, DriveWatch& watch, const Measurement& m, Mode mode) {
  ++watch.tick;
  if (mode != Mode::Active && mode != Mode::Hold) watch.signed_mVms = watch.total_mVms = watch.wave_ticks = 0;
  // A plan for the bench may begin and hold with one polarity; its balance is what ends that.
  const bool for_patient = is_for_patient(plan);
  const bool judged = mode == Mode::Active || (mode == Mode::Hold && for_patient);
  if (!judged || magnitude(m.command_mV) < kWaveMin_mV) return forget_wave(watch), 0;
  const std::int32_t polarity = m.command_mV < 0 ? -1 : 1;
  const std::int32_t half_period = half_period_ticks(plan);
  if (watch.polarity == 0) watch.flip_tick[0] = watch.tick;
  if (watch.polarity == -polarity) note_flip(watch, half_period);
  watch.polarity = polarity;
  const std::int64_t forgetting = forgetting_ticks(half_period);
  const auto seen = static_cast<std::int32_t>(forgetting / kForgetPerSeen);
  watch.signed_mVms += m.monitor_mV - watch.signed_mVms / forgetting;
  watch.total_mVms += magnitude(m.monitor_mV) - watch.total_mVms / forgetting;
  watch.wave_ticks = std::min(watch.wave_ticks + 1, seen);
  const bool unbalanced = watch.wave_ticks >= seen && 2 * std::abs(watch.signed_mVms) > watch.total_mVms;
  return when(unbalanced, Hazard::PolarityStuck) |
         when(watch.wrong_frequency || (for_patient && is_too_slow(watch)), Hazard::WrongFrequency);
}

// Rounded down; of squares up to 8191^2.
std::int64_t root_of(std::int64_t square) {
  std::int64_t root = 0;
  for (std::int64_t bit = std::int64_t{1} << 12; bit > 0; bit /= 2)
    if ((root + bit) * (root + bit) <= square) root += bit;
  return root;
}

// A plan for the bench moves no needle, and steps as it likes.
std::int32_t look_at_pull(const PlanFacts& plan, DriveWatch& watch, const Measurement& m, Mode mode) {
  constexpr std::int64_t kMost_V = limits::kDriveMax_mV / 1'000;
  const std::int64_t drive_V = std::min(magnitude(m.command_mV) / 1'000, kMost_V);
  watch.pull_V2 = std::clamp<std::int64_t>(watch.pull_V2, 0, kMost_V * kMost_V);
  watch.pull_V2 += (drive_V * drive_V - watch.pull_V2) / kPull_ticks;
  if (!is_hot(mode)) watch.pull_V2 = 0;
  if (!is_for_patient(plan)) return limits::kDriveMax_mV;
  return static_cast<std::int32_t>(std::min(root_of(watch.pull_V2 + kPullLead_V2), kMost_V) * 1'000);
}

bool is_switching(std::int32_t before_mV, std::int32_t after_mV) {
  return std::abs(std::int64_t{after_mV} - before_mV) > limits::kZeroVolt_mV;
}

}  // namespace

DriveFindings look(const PlanFacts& plan, DriveWatch& watch, const Observation& seen, bool fresh,
                   bool stale) {
  const Measurement& m = seen.measurement;
  DriveFindings findings;
  findings.image_disturbed = seen.acquiring && (!fresh || is_switching(watch.command_mV, m.command_mV));
  if (fresh) {
    watch.found = look_at_voltage(watch, m);
    watch.found |= look_at_current(watch, m);
    watch.found |= look_at_obedience(watch, m, seen.permit);
    watch.found |= look_at_zero(watch, m, seen.permit.mode);
    watch.found |= look_at_wave(plan, watch, m, seen.permit.mode);
    watch.ceiling_mV = look_at_pull(plan, watch, m, seen.permit.mode);
    watch.command_mV = m.command_mV;
  }
  findings.found = watch.found;
  findings.ceiling_mV = watch.ceiling_mV;
  if (stale) watch.zero_volts = false, watch.zero_ticks = 0;
  findings.zero_volts = watch.zero_volts;
  findings.drive_mV =
      static_cast<std::int32_t>(std::min<std::int64_t>(magnitude(watch.command_mV), limits::kDriveMax_mV));
  return findings;
}

}  // namespace biopsy::safety
