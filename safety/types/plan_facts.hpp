// What the supervisor must know of a sealed plan: integers of fixed size, made once at set-up, constant
// after.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace biopsy::safety {

inline constexpr std::size_t kMaxSteps = 32;
inline constexpr std::size_t kMaxBands = 32;

// Limits of one step. The cycle turns the step's speed into a slew with the steepest slope of the
// plausible band.
struct StepLimits {
  std::int32_t depth_max_um = 0;         // the step's depth plus the overshoot allowed there: no rise beyond
  std::int32_t v_max_mV = 0;             // envelope of |V|: stored energy ahead of a boundary
  std::int32_t slew_up_mV_per_tick = 0;  // rise of |V| per ms
  bool image_confirms = true;            // a depth check must say Accept before the next step
};

// Depths that are plausible at a steady |V|; linear in between, constant beyond the ends. Rising in drive.
struct PlausibleBand {
  std::int32_t drive_mV = 0;
  std::int32_t low_um = 0, high_um = 0;
};

struct PlanFacts {
  std::uint64_t plan_tag = 0;                // first 8 bytes of the seal; 0 = no plan
  std::uint64_t config_tag = 0;              // of the configuration at start; 0 = none
  std::int32_t depth_max_um = 0;             // target plus the allowed overshoot (PlanLimits::depth_max)
  std::int32_t tissue_residual_max_um = 0;   // |depth - depth the tissue model expects| that is still normal
  std::int32_t bench_half_period_ticks = 0;  // 0: for a patient, polarity at 2 Hz; else a bench plan's own
  std::uint32_t step_count = 0;
  std::uint32_t band_count = 0;
  std::array<StepLimits, kMaxSteps> steps{};
  std::array<PlausibleBand, kMaxBands> bands{};
};

// Whether every number is one this robot could mean: a plan in metres or volts fails here. A default plan
// fails.
bool is_plausible(const PlanFacts& plan);

// Whatever is not a bench's own rate is for a patient.
constexpr bool is_for_patient(const PlanFacts& plan) {
  return plan.bench_half_period_ticks <= 0;
}

// Ticks between two changes of polarity that this plan is held to.
std::int32_t half_period_ticks(const PlanFacts& plan);

// |V|, mV, from which the needle could have lifted by 1 mm at most; the last band's where no band says so.
std::int32_t lifting_drive_mV(const PlanFacts& plan);

struct DepthRange {
  std::int32_t low_um = 0, high_um = 0;
};
// Depths plausible where |V| was between the two drives; {0, 0} for a plan without bands.
DepthRange plausible_depth(const PlanFacts& plan, std::int32_t drive_low_mV, std::int32_t drive_high_mV);

}  // namespace biopsy::safety
