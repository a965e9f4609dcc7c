#include "planner/plan/bench_plan.hpp"

#include <fmt/format.h>

#include "planner/plan/nominal_model.hpp"
#include "planner/plan/seal.hpp"
#include "safety/types/limits.hpp"

namespace biopsy::planner {
namespace {

constexpr Millimetres kStroke = from_um(limits::kStroke_um);
constexpr Millimetres kMargin = from_um(limits::kDepthMargin_um);
constexpr Volts kMost = from_mV(limits::kDriveMax_mV);
constexpr Volts kLeast = from_mV(limits::kZeroVolt_mV);
constexpr Millimetres kBelowRest{1.0};   // a push on the plate at rest bends the series spring
constexpr Millimetres kHoldBefore{0.5};  // of the end of the stroke: what a stage may pass its depth by

}  // namespace

Millimetres expected_travel(const BenchRequest& request) {
  const double share = film_share({}, request.half_period).start;
  return NominalModel(request.weight).depth_on_films(share * request.highest / request.drive_scale);
}

std::variant<Plan, PlanRefusal> plan_bench(const BenchRequest& request) {
  const bool modelled = request.weight >= Grams(0) && request.weight <= kWeightMax;
  if (!modelled)
    return PlanRefusal{
        fmt::format("a weight of {:.0f} g is outside 0 to {:.0f} g", request.weight.value, kWeightMax.value),
        "put less on the fixture"};
  if (!(request.drive_scale >= 1.0 && request.drive_scale <= kDriveScaleMax))
    return PlanRefusal{fmt::format("a stage that needs {:g} times the nominal voltage is outside 1 to {:g}",
                                   request.drive_scale, kDriveScaleMax),
                       "measure with 1 first; the report says how far the stage went"};
  if (!(request.highest >= kLeast && request.highest <= kMost))
    return PlanRefusal{fmt::format("{:.2f} kV is outside {:.1f} to {:.1f} kV", request.highest.value * 1e-3,
                                   kLeast.value * 1e-3, kMost.value * 1e-3),
                       "put less on the fixture, or ask for less voltage (--drive-scale)"};
  if (const Millimetres travel = expected_travel(request); travel > kStroke - kMargin)
    return PlanRefusal{
        fmt::format("the stage would go {:.1f} mm, nearer than {:.1f} mm to the end of its stroke",
                    travel.value, kMargin.value),
        "put more on the fixture, or ask for less voltage"};
  Plan plan;
  plan.target_depth = kStroke - kHoldBefore;
  plan.steps = {{.kind = StepKind::Target,
                 .depth = plan.target_depth,
                 .speed = {},
                 .v_max = request.highest,
                 .image_confirms = false,
                 .why = request.what}};
  plan.limits = {.depth_max = kStroke,
                 .v_max = request.highest,
                 .plausible = {{Volts(0), -kBelowRest, kStroke}, {kMost, -kBelowRest, kStroke}}};
  plan.bench = BenchDrive{request.half_period};
  seal(plan);
  return plan;
}

}  // namespace biopsy::planner
