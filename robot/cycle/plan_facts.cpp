#include "robot/cycle/plan_facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/plan/seal.hpp"
#include "robot/common/config_error.hpp"
#include "safety/types/limits.hpp"

namespace biopsy::robot {
namespace {

// Allowed beyond a step's depth before the supervisor holds: the paper's overshoot (13 % of 2 mm) and half
// the jump of a puncture; half of the plan's own margin.
constexpr Millimetres kStepOvershoot{0.5};
// The plausible band includes tissue, friction and hysteresis; 0.5 mm outside it is another tissue.
constexpr std::int32_t kTissueResidual_um = 500;
// P action answers each sample: 10 um of laser noise and a 1 mm puncture (0.8 kV) within 10 ms.
constexpr std::int32_t kSlewUp_mV_per_tick = 80'000;
static_assert(kSlewUp_mV_per_tick <= limits::kSlewUpMax_mV_per_tick);

}  // namespace

safety::PlanFacts plan_facts(const Plan& plan, std::uint64_t config_tag) {
  safety::PlanFacts facts;
  if (plan.steps.size() > facts.steps.size() || plan.limits.plausible.size() > facts.bands.size())
    throw ConfigError(
        fmt::format("the plan has {} steps; the supervisor holds {}", plan.steps.size(), facts.steps.size()),
        "plan", "ask for fewer waypoints or merge thin layers");
  facts.plan_tag = planner::plan_tag(plan);
  facts.config_tag = config_tag;
  // A seal says who made a plan, not that its limit belongs to its target.
  facts.depth_max_um =
      std::min(to_um(plan.limits.depth_max), to_um(plan.target_depth) + limits::kDepthMargin_um);
  facts.tissue_residual_max_um = kTissueResidual_um;
  if (plan.bench)  // never 0, which would make it a plan for a patient
    facts.bench_half_period_ticks = std::max(1, to_integer(plan.bench->half_period / kTick));
  for (const InsertionStep& step : plan.steps)
    facts.steps[facts.step_count++] = {
        .depth_max_um = std::min(to_um(step.depth + kStepOvershoot), facts.depth_max_um),
        .v_max_mV = to_mV(step.v_max),
        .slew_up_mV_per_tick = kSlewUp_mV_per_tick,
        .image_confirms = step.image_confirms};
  for (const DepthBand& band : plan.limits.plausible)
    facts.bands[facts.band_count++] = {to_mV(band.drive), to_um(band.low), to_um(band.high)};
  return facts;
}

}  // namespace biopsy::robot
