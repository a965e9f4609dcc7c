#include "safety/types/plan_facts.hpp"

#include <algorithm>
#include <span>

#include "safety/types/limits.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::safety {
namespace {

constexpr bool is_within(std::int32_t value, std::int32_t low, std::int32_t high) {
  return value >= low && value <= high;
}

// A slew of less than 1 V/ms could not cross the stroke within a hold; less than 100 um is no step but a
// slip of units.
constexpr std::int32_t kStepMin_um = 100, kSlewMin_mV = 1'000;

bool is_plausible(const StepLimits& step, std::int32_t plan_depth_max_um) {
  return is_within(step.depth_max_um, kStepMin_um, plan_depth_max_um) &&
         is_within(step.v_max_mV, limits::kZeroVolt_mV, limits::kDriveMax_mV) &&
         is_within(step.slew_up_mV_per_tick, kSlewMin_mV, limits::kSlewUpMax_mV_per_tick);
}

bool is_plausible(const PlausibleBand& band) {
  return is_within(band.drive_mV, 0, limits::kMonitorTrip_mV) &&
         is_within(band.low_um, -limits::kStroke_um, 2 * limits::kStroke_um) &&
         is_within(band.high_um, band.low_um, 2 * limits::kStroke_um);
}

// With a patient a plan cannot widen what its supervisor looks for: the seal tells who made it, not that it
// is right. The plan ends 0.5 mm beyond what its deepest step may reach, which is 0.5 mm beyond that step
// (robot/cycle/plan_facts).
constexpr std::int32_t kBeyondSteps_um = 501;  // one for rounding
// Of every model and weight here the band ends at 4.5 mm at rest, where a needle may be held by friction, at
// 16.1 mm at 3 kV and at 20.8 mm at 8 kV.
constexpr std::int32_t kRestLow_um = -1'000, kRestHigh_um = 5'000, kHighest_um = 21'000;
constexpr std::int64_t kSteepest_um_per_kV = 3'800;
// And a needle of 300 g may have lifted from 3.5 kV on: without that no standing still would be a fault.
constexpr std::int32_t kLiftingMax_mV = 4'000'000;

// The highest depth that any stage of this kind could have.
constexpr std::int64_t highest_um(std::int32_t drive_mV) {
  return std::min<std::int64_t>(kRestHigh_um + drive_mV * kSteepest_um_per_kV / 1'000'000, kHighest_um);
}

bool is_bounded(const PlanFacts& plan) {
  const std::span steps = std::span(plan.steps).first(plan.step_count);
  if (!std::ranges::is_sorted(steps, {}, &StepLimits::depth_max_um)) return false;
  if (!steps.back().image_confirms) return false;  // no target is reached unseen
  if (plan.depth_max_um > steps.back().depth_max_um + kBeyondSteps_um) return false;
  if (plan.bands[0].drive_mV != 0) return false;  // what follows is said of the needle at rest
  if (plan.bands[0].low_um < kRestLow_um || lifting_drive_mV(plan) > kLiftingMax_mV) return false;
  for (std::size_t i = 0; i < plan.band_count; ++i)
    if (plan.bands[i].high_um > highest_um(plan.bands[i].drive_mV)) return false;
  for (std::size_t i = 1; i < plan.band_count; ++i)
    if (plan.bands[i].low_um < plan.bands[i - 1].low_um || plan.bands[i].high_um < plan.bands[i - 1].high_um)
      return false;
  return true;
}

// A depth that a band may mean, whatever stands there: what is interpolated cannot overflow.
constexpr std::int32_t bounded_um(std::int32_t um) {
  return std::clamp(um, -limits::kStroke_um, 2 * limits::kStroke_um);
}

constexpr DepthRange range_of(const PlausibleBand& band) {
  return {bounded_um(band.low_um), bounded_um(band.high_um)};
}

std::int32_t between(std::int64_t from, std::int64_t to, std::int64_t part, std::int64_t whole) {
  return static_cast<std::int32_t>(from + (to - from) * part / whole);
}

DepthRange plausible_at(const PlanFacts& plan, std::int32_t drive_mV) {
  if (plan.band_count == 0) return {};
  const std::size_t count = plan.band_count < kMaxBands ? plan.band_count : kMaxBands;
  std::size_t above = 0;
  while (above < count && plan.bands[above].drive_mV < drive_mV) ++above;
  if (above == 0) return range_of(plan.bands[0]);
  if (above == count) return range_of(plan.bands[count - 1]);
  const PlausibleBand& a = plan.bands[above - 1];
  const PlausibleBand& b = plan.bands[above];
  const std::int64_t part = std::int64_t{drive_mV} - a.drive_mV,
                     whole = std::int64_t{b.drive_mV} - a.drive_mV;
  const DepthRange from = range_of(a), to = range_of(b);
  return {between(from.low_um, to.low_um, part, whole), between(from.high_um, to.high_um, part, whole)};
}

}  // namespace

bool is_plausible(const PlanFacts& plan) {
  if (plan.bench_half_period_ticks != half_period_ticks(plan) && plan.bench_half_period_ticks != 0)
    return false;
  if (!is_within(plan.depth_max_um, kStepMin_um, limits::kStroke_um)) return false;
  if (!is_within(plan.tissue_residual_max_um, 1, limits::kStroke_um)) return false;
  if (plan.step_count == 0 || plan.step_count > kMaxSteps) return false;
  if (plan.band_count == 0 || plan.band_count > kMaxBands) return false;
  for (std::size_t i = 0; i < plan.step_count; ++i)
    if (!is_plausible(plan.steps[i], plan.depth_max_um)) return false;
  for (std::size_t i = 0; i < plan.band_count; ++i)
    if (!is_plausible(plan.bands[i])) return false;
  for (std::size_t i = 1; i < plan.band_count; ++i)
    if (plan.bands[i].drive_mV <= plan.bands[i - 1].drive_mV) return false;
  const std::int32_t judged_up_to_mV = plan.bands[plan.band_count - 1].drive_mV;
  for (std::size_t i = 0; i < plan.step_count; ++i)
    if (plan.steps[i].v_max_mV > judged_up_to_mV) return false;
  return !is_for_patient(plan) || is_bounded(plan);
}

std::int32_t half_period_ticks(const PlanFacts& plan) {
  const bool own =
      is_within(plan.bench_half_period_ticks, kBenchHalfPeriodMin_ticks, kBenchHalfPeriodMax_ticks);
  return own ? plan.bench_half_period_ticks : kHalfPeriod_ticks;
}

std::int32_t lifting_drive_mV(const PlanFacts& plan) {
  if (plan.band_count == 0) return 0;
  const std::size_t count = plan.band_count < kMaxBands ? plan.band_count : kMaxBands;
  const std::int32_t lifted_um = range_of(plan.bands[0]).high_um + kLifted_um;
  for (std::size_t i = 1; i < count; ++i) {
    const PlausibleBand& a = plan.bands[i - 1];
    const PlausibleBand& b = plan.bands[i];
    const std::int32_t from_um = range_of(a).high_um, to_um = range_of(b).high_um;
    if (to_um >= lifted_um)  // the first: the one before was below
      return between(a.drive_mV, b.drive_mV, lifted_um - from_um, to_um - from_um);
  }
  return plan.bands[count - 1].drive_mV;
}

DepthRange plausible_depth(const PlanFacts& plan, std::int32_t drive_low_mV, std::int32_t drive_high_mV) {
  return {plausible_at(plan, drive_low_mV).low_um, plausible_at(plan, drive_high_mV).high_um};
}

}  // namespace biopsy::safety
