#include "safety/monitors/voltage_monitor.hpp"

#include <algorithm>
#include <cstdlib>

#include "safety/monitors/debounce.hpp"
#include "safety/types/limits.hpp"
#include "safety/types/magnitude.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::safety {
namespace {

HazardSet check_voltage(VoltageMonitor& monitor, const Measurement& m) {
  const std::int64_t larger = std::max(magnitude(m.command_mV), magnitude(monitor.command_mV));
  const std::int64_t tolerance = std::max<std::int64_t>(kDisagreeFloor_mV, larger * kDisagree_percent / 100);
  // The monitor may lag by one tick: anything between the last two commands is right.
  const std::int64_t lowest = std::min(m.command_mV, monitor.command_mV) - tolerance;
  const std::int64_t highest = std::max(m.command_mV, monitor.command_mV) + tolerance;
  const bool differs = m.hv_enabled && (m.monitor_mV < lowest || m.monitor_mV > highest);
  const bool over = magnitude(m.monitor_mV) > limits::kMonitorTrip_mV;
  monitor.disagree_score = accumulated(monitor.disagree_score, differs, kComes_goes, kDisagree_ticks);
  monitor.over_ticks = debounced(monitor.over_ticks, over, kOverVoltage_ticks);
  return when(monitor.disagree_score >= kComes_goes * kDisagree_ticks, Hazard::MonitorDisagrees) |
         when(monitor.over_ticks >= kOverVoltage_ticks, Hazard::OverVoltage);
}

HazardSet check_current(VoltageMonitor& monitor, const Measurement& m) {
  const std::int64_t change = std::abs(std::int64_t{m.command_mV} - monitor.command_mV);
  const std::int64_t largest = std::max({change, monitor.change_mV[0], monitor.change_mV[1]});
  const bool excess = magnitude(m.current_nA) > kCapacitive_nA_per_mV * largest + kArcMargin_nA;
  monitor.change_mV = {change, monitor.change_mV[0]};
  monitor.arc_score = accumulated(monitor.arc_score, excess, kComes_goes, kArc_ticks);
  return when(monitor.arc_score >= kComes_goes * kArc_ticks, Hazard::Arc);
}

// The permit that the driver says it had: what arrives late was measured under an earlier one, and is no
// disobedience. Whether the answer is right and new enough is R-10's matter; without one it is the newest.
const Permitted& answered_permit(const VoltageMonitor& monitor, const Measurement& m, const Permit& newest) {
  const std::uint32_t age = newest.seq - m.answered_seq;  // wraps to huge for an answer from the future
  const bool known = m.answered_seq != 0 && age <= kAnswerWindow;
  return monitor.permitted[(known ? m.answered_seq : newest.seq) % 8];
}

HazardSet check_obedience(VoltageMonitor& monitor, const Measurement& m, const Permit& newest) {
  const Permitted& permit = answered_permit(monitor, m, newest);
  const bool beyond = magnitude(m.command_mV) > std::int64_t{permit.v_max_mV} + kDisobey_mV;
  monitor.disobey_ticks =
      debounced(monitor.disobey_ticks,
                beyond || m.hv_enabled != permit.hv_enable || (m.brake_on && !permit.brake), kDisobey_ticks);
  return when(monitor.disobey_ticks >= kDisobey_ticks, Hazard::DriverDisobeys);
}

// Zero needs three quiet samples, and is lost at once by a command, by the monitor only after three.
HazardSet check_zero(VoltageMonitor& monitor, const Measurement& m, Mode mode) {
  const bool present = magnitude(m.monitor_mV) > limits::kZeroVolt_mV;
  const bool commanded = magnitude(m.command_mV) > limits::kZeroVolt_mV;
  monitor.zero_ticks = debounced(monitor.zero_ticks, !present && !commanded, kZero_ticks);
  monitor.nonzero_ticks = debounced(monitor.nonzero_ticks, present, kZero_ticks);
  if (monitor.zero_ticks >= kZero_ticks) monitor.zero_volts = true;
  if (commanded || monitor.nonzero_ticks >= kZero_ticks) monitor.zero_volts = false;
  monitor.off_ticks = debounced(monitor.off_ticks, !hv_permitted(mode), kResidual_ticks);
  return when(monitor.off_ticks >= kResidual_ticks && monitor.nonzero_ticks >= kZero_ticks,
              Hazard::ResidualCharge);
}

void forget_wave(VoltageMonitor& monitor) {
  monitor.flips = 0;
  monitor.polarity = 0;
  monitor.wrong_frequency = false;
}

void note_flip(VoltageMonitor& monitor, std::int32_t half_period) {
  if (monitor.flips == 4) {  // four half-periods lie between the oldest of these and now
    const std::int64_t two_periods = kTwoPeriods_half_periods * half_period;
    const std::int64_t off = monitor.tick - monitor.flip_tick[3] - two_periods;
    monitor.wrong_frequency = kOffOneIn * std::abs(off) > two_periods;
  }
  monitor.flip_tick = {monitor.tick, monitor.flip_tick[0], monitor.flip_tick[1], monitor.flip_tick[2]};
  monitor.flips = std::min(monitor.flips + 1, 4);
}

// Already longer than any sound wave takes, since one of the last flips or since the wave began.
bool is_too_slow(const VoltageMonitor& monitor) {
  constexpr std::int64_t kAllowed = kTwoPeriods_half_periods * kHalfPeriod_ticks / kOffOneIn;
  const std::int32_t oldest = std::clamp(monitor.flips, 0, 3);  // the begin, while there were fewer than four
  for (std::int32_t i = 0; i <= oldest; ++i) {
    const std::int64_t ago = monitor.tick - monitor.flip_tick[static_cast<std::size_t>(i)];
    if (ago - std::int64_t{i + 1} * kHalfPeriod_ticks > kAllowed) return true;
  }
  return false;
}

// A slow wave needs as many of its own periods to show its balance.
std::int64_t forgetting_ticks(std::int32_t half_period) {
  return kForget_ticks * std::max(half_period, kHalfPeriod_ticks) / kHalfPeriod_ticks;
}

HazardSet check_wave(const PlanFacts& plan, VoltageMonitor& monitor, const Measurement& m, Mode mode) {
  ++monitor.tick;
  if (mode != Mode::Active && mode != Mode::Hold)
    monitor.signed_mVms = monitor.total_mVms = monitor.wave_ticks = 0;
  // A plan for the bench may begin and hold with one polarity; its balance is what ends that.
  const bool for_patient = is_for_patient(plan);
  const bool judged = mode == Mode::Active || (mode == Mode::Hold && for_patient);
  if (!judged || magnitude(m.command_mV) < kWaveMin_mV) return forget_wave(monitor), 0;
  const std::int32_t polarity = m.command_mV < 0 ? -1 : 1;
  const std::int32_t half_period = half_period_ticks(plan);
  if (monitor.polarity == 0) monitor.flip_tick[0] = monitor.tick;
  if (monitor.polarity == -polarity) note_flip(monitor, half_period);
  monitor.polarity = polarity;
  const std::int64_t forgetting = forgetting_ticks(half_period);
  const auto seen = static_cast<std::int32_t>(forgetting / kForgetPerSeen);
  monitor.signed_mVms += m.monitor_mV - monitor.signed_mVms / forgetting;
  monitor.total_mVms += magnitude(m.monitor_mV) - monitor.total_mVms / forgetting;
  monitor.wave_ticks = std::min(monitor.wave_ticks + 1, seen);
  const bool unbalanced =
      monitor.wave_ticks >= seen && 2 * std::abs(monitor.signed_mVms) > monitor.total_mVms;
  return when(unbalanced, Hazard::PolarityStuck) |
         when(monitor.wrong_frequency || (for_patient && is_too_slow(monitor)), Hazard::WrongFrequency);
}

// Rounded down; of squares up to 8191^2.
std::int64_t root_of(std::int64_t square) {
  std::int64_t root = 0;
  for (std::int64_t bit = std::int64_t{1} << 12; bit > 0; bit /= 2)
    if ((root + bit) * (root + bit) <= square) root += bit;
  return root;
}

// A plan for the bench moves no needle, and steps as it likes.
std::int32_t check_pull(const PlanFacts& plan, VoltageMonitor& monitor, const Measurement& m, Mode mode) {
  constexpr std::int64_t kMost_V = limits::kDriveMax_mV / 1'000;
  const std::int64_t drive_V = std::min(magnitude(m.command_mV) / 1'000, kMost_V);
  monitor.pull_V2 = std::clamp<std::int64_t>(monitor.pull_V2, 0, kMost_V * kMost_V);
  monitor.pull_V2 += (drive_V * drive_V - monitor.pull_V2) / kPull_ticks;
  if (!hv_permitted(mode)) monitor.pull_V2 = 0;
  if (!is_for_patient(plan)) return limits::kDriveMax_mV;
  return static_cast<std::int32_t>(std::min(root_of(monitor.pull_V2 + kPullLead_V2), kMost_V) * 1'000);
}

// A locked needle could jump by what the drive exceeds the one that held it.
std::int32_t check_lock(VoltageMonitor& monitor, const Measurement& m) {
  if (m.brake_on && !monitor.brake_on) monitor.locked_mV = drive_magnitude_mV(m.command_mV);
  monitor.brake_on = m.brake_on;
  return m.brake_on ? std::min(monitor.locked_mV + kPastLocked_mV, limits::kDriveMax_mV)
                    : limits::kDriveMax_mV;
}

bool is_switching(std::int32_t before_mV, std::int32_t after_mV) {
  return std::abs(std::int64_t{after_mV} - before_mV) > limits::kZeroVolt_mV;
}

}  // namespace

DriveFindings update(const PlanFacts& plan, VoltageMonitor& monitor, const SupervisorInputs& seen, bool fresh,
                     bool stale) {
  const Measurement& m = seen.measurement;
  const Permit& newest = seen.permit;
  monitor.permitted[newest.seq % 8] = {newest.v_max_mV, newest.hv_enable, newest.brake};
  DriveFindings findings;
  findings.image_disturbed = seen.acquiring && (!fresh || is_switching(monitor.command_mV, m.command_mV));
  if (fresh) {
    monitor.found = check_voltage(monitor, m);
    monitor.found |= check_current(monitor, m);
    monitor.found |= check_obedience(monitor, m, seen.permit);
    monitor.found |= check_zero(monitor, m, seen.permit.mode);
    monitor.found |= check_wave(plan, monitor, m, seen.permit.mode);
    monitor.ceiling_mV = std::min(check_pull(plan, monitor, m, seen.permit.mode), check_lock(monitor, m));
    monitor.command_mV = m.command_mV;
  }
  findings.found = monitor.found;
  findings.ceiling_mV = monitor.ceiling_mV;
  if (stale) monitor.zero_volts = false, monitor.zero_ticks = 0;
  findings.zero_volts = monitor.zero_volts;
  findings.drive_mV = drive_magnitude_mV(monitor.command_mV);
  return findings;
}

}  // namespace biopsy::safety
