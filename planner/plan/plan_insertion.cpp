#include "planner/plan/plan_insertion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "planner/plan/layers.hpp"
#include "planner/plan/nominal_model.hpp"
#include "planner/plan/seal.hpp"
#include "safety/types/limits.hpp"

namespace biopsy::planner {
namespace {

using Refusal = std::optional<PlanRefusal>;  // empty: nothing to refuse

constexpr Millimetres kDepthMargin = from_um(limits::kDepthMargin_um);
constexpr Millimetres kDeepest = from_um(limits::kStroke_um - limits::kDepthMargin_um);

// Where the target lies as the needle sees it.
struct Aim {
  Point p_RT;
  Millimetres depth() const { return Millimetres(p_RT.z()); }
  Millimetres offset() const { return Millimetres(std::hypot(p_RT.x(), p_RT.y())); }
};

// "3.1 mm left, 0.4 mm posterior": a patient direction in words; parts below 0.05 mm are left out.
std::string direction_text(const Eigen::Vector3d& lps_mm) {
  constexpr const char* kToward[3][2] = {
      {"left", "right"}, {"posterior", "anterior"}, {"superior", "inferior"}};
  std::string text;
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(lps_mm(axis)) >= 0.05)
      text += fmt::format("{}{:.1f} mm {}", text.empty() ? "" : ", ", std::abs(lps_mm(axis)),
                          kToward[axis][lps_mm(axis) < 0.0 ? 1 : 0]);
  return text;
}

Refusal loosened(const InsertionRequest& request) {
  const Tolerances most;
  const Tolerances& asked = request.tolerances;
  const bool tolerances_hold = asked.axis_offset <= most.axis_offset &&
                               asked.entry_offset <= most.entry_offset && asked.fre_mm <= most.fre_mm &&
                               asked.tre_mm <= most.tre_mm;
  if (!tolerances_hold)
    return PlanRefusal{
        "a tolerance was asked for that is wider than the program allows",
        fmt::format("ask for at most {:.1f} mm off the axis and at the entry, FRE {:.1f} mm, TRE {:.1f} mm",
                    most.axis_offset.value, most.fre_mm, most.tre_mm)};
  const Pace& pace = request.pace;
  const bool pace_holds = pace.speed.value > 0.0 && pace.speed <= kSpeedMax && pace.crossing.value > 0.0 &&
                          pace.crossing <= pace.speed && pace.dwell.count() > 0.0 && pace.dwell <= kDwellMax;
  if (!pace_holds)
    return PlanRefusal{
        fmt::format("the pace is out of range (speed {:.2f} mm/s, crossing {:.2f} mm/s, dwell {:.2f} s)",
                    pace.speed.value, pace.crossing.value, pace.dwell.count()),
        fmt::format(
            "speeds above 0 and up to {:.0f} mm/s, crossing not faster than the rest, dwell up to {:.0f} s",
            kSpeedMax.value, kDwellMax.count())};
  return {};
}

Refusal untrusted_registration(const InsertionRequest& request) {
  const Eigen::Matrix3d rotation = request.X_SR.linear();
  if (!(rotation * rotation.transpose()).isIdentity(1e-6) || !(rotation.determinant() > 0.0) ||
      !request.X_SR.translation().allFinite())
    return PlanRefusal{"the robot-to-scanner transform is not a rotation and a translation",
                       "register the robot again, or correct the transform that was given"};
  if (!(request.registration_fre_mm <= request.tolerances.fre_mm))
    return PlanRefusal{fmt::format("fiducial registration error {:.2f} mm is above the limit of {:.2f} mm",
                                   request.registration_fre_mm, request.tolerances.fre_mm),
                       "measure the fiducials again"};
  if (!(request.registration_tre_mm <= request.tolerances.tre_mm))
    return PlanRefusal{
        fmt::format("the expected registration error at the target is {:.2f} mm, above the limit of "
                    "{:.2f} mm",
                    request.registration_tre_mm, request.tolerances.tre_mm),
        "place the fiducials closer around the target or further apart, or add some, and register again"};
  return {};
}

Refusal entry_elsewhere(const InsertionRequest& request) {
  const Eigen::Vector3d away = request.X_SR.translation() - request.target.p_SE;  // tip - entry
  if (away.norm() <= request.tolerances.entry_offset.value) return {};
  return PlanRefusal{
      fmt::format(
          "the needle tip waits {:.1f} mm from the entry chosen on the image ({}), more than {:.1f} mm",
          away.norm(), direction_text(away), request.tolerances.entry_offset.value),
      "choose the entry where the tip is, move the needle guide, or check the registration (is a point in "
      "LPS typed "
      "as RAS, or from another series?)"};
}

Refusal out_of_reach(const Aim& aim, const InsertionRequest& request) {
  if (aim.depth().value <= 0.0)
    return PlanRefusal{
        fmt::format("the target lies {:.1f} mm behind the needle tip", -aim.depth().value),
        "turn the needle guide towards the target, or withdraw it until the target is in front of the tip"};
  if (aim.offset() > request.tolerances.axis_offset) {
    const Eigen::Vector3d sideways = request.X_SR.linear() * Eigen::Vector3d(aim.p_RT.x(), aim.p_RT.y(), 0.0);
    const double turn_deg = std::atan2(aim.offset().value, aim.depth().value) * 180.0 / std::numbers::pi;
    return PlanRefusal{
        fmt::format(
            "the target lies {:.1f} mm off the needle axis ({}), more than {:.1f} mm; the stage only moves "
            "along its axis",
            aim.offset().value, direction_text(sideways), request.tolerances.axis_offset.value),
        fmt::format("move the needle guide {}, or re-aim it by {:.1f} degrees that way, and register again",
                    direction_text(sideways), turn_deg)};
  }
  if (aim.depth() < kTargetMin)
    return PlanRefusal{fmt::format("the target is {:.2f} mm in front of the tip, nearer than {:.1f} mm",
                                   aim.depth().value, kTargetMin.value),
                       "withdraw the needle guide a little; the loop does not hold so small a depth"};
  if (aim.depth() > kDeepest)
    return PlanRefusal{
        fmt::format("the target is {:.1f} mm in front of the tip, {:.1f} mm beyond the usable stroke of "
                    "{:.1f} mm",
                    aim.depth().value, (aim.depth() - kDeepest).value, kDeepest.value),
        fmt::format("advance the needle guide by at least {:.1f} mm and register again",
                    (aim.depth() - kDeepest).value)};
  return {};
}

Refusal unknown_tissue(const std::vector<Layer>& layers, Millimetres depth) {
  if (const std::string fault = layer_fault(layers); !fault.empty())
    return PlanRefusal{fault, "give layers from the entry inwards, each beginning where the one before ends"};
  if (!(layers.back().to > depth))
    return PlanRefusal{fmt::format("the tissue layers end at {:.2f} mm, before the target at {:.2f} mm",
                                   layers.back().to.value, depth.value),
                       "extend the layer table or the label map beyond the target"};
  return {};
}

Refusal waypoints_astray(const std::vector<Millimetres>& waypoints, Millimetres depth) {
  Millimetres previous{0.0};
  for (const Millimetres waypoint : waypoints) {
    const bool rises = waypoint >= previous + kStepMin && waypoint <= depth - kStepMin;
    if (!rises)
      return PlanRefusal{
          fmt::format("the stop at {:.2f} mm does not lie between {:.2f} mm and the target at {:.2f} mm",
                      waypoint.value, previous.value, depth.value),
          fmt::format("give stops in rising order, at least {:.1f} mm apart and short of the target",
                      kStepMin.value)};
    previous = waypoint;
  }
  return {};
}

Refusal too_heavy(const InsertionRequest& request, Millimetres depth) {
  const bool modelled = request.weight.value >= 0.0 && request.weight <= kWeightMax;
  if (!modelled)
    return PlanRefusal{
        fmt::format("a weight of {:.0f} g is outside 0 to {:.0f} g", request.weight.value, kWeightMax.value),
        "give the weight on the needle fixture in grams"};
  const std::optional<Volts> drive =
      NominalModel(request.weight, request.stage).drive(depth, kTissueForceMin_N);
  if (!drive || *drive > from_mV(limits::kDriveMax_mV))
    return PlanRefusal{
        fmt::format(
            "with {:.0f} g the stage cannot hold {:.1f} mm against {:.1f} N of tissue within {:.1f} kV",
            request.weight.value, depth.value, kTissueForceMin_N, limits::kDriveMax_mV * 1e-6),
        "use a lighter weight, or advance the needle guide so that the target is nearer"};
  return {};
}

Refusal loop_astray(const PiGains& gains) {
  if (is_permitted(gains)) return {};
  return PlanRefusal{
      fmt::format("gains of {:.4g} V/mm and {:.4g} V/mm at each tick are outside {:.4g} to {:.4g} and {:.4g} "
                  "to {:.4g}",
                  gains.proportional_V_per_mm, gains.integral_V_per_mm_per_tick,
                  kLeastGains.proportional_V_per_mm, kMostGains.proportional_V_per_mm,
                  kLeastGains.integral_V_per_mm_per_tick, kMostGains.integral_V_per_mm_per_tick),
      "give gains as `biopsy tune` finds them"};
}

Refusal first_objection(const InsertionRequest& request, const Aim& aim) {
  if (Refusal why = loosened(request)) return why;
  if (Refusal why = untrusted_registration(request)) return why;
  if (!aim.p_RT.allFinite() || !request.target.p_SE.allFinite())
    return PlanRefusal{"entry or target is not a number", "choose both points on the image again"};
  if (Refusal why = entry_elsewhere(request)) return why;
  if (Refusal why = out_of_reach(aim, request)) return why;
  if (Refusal why = unknown_tissue(request.layers, aim.depth())) return why;
  if (Refusal why = waypoints_astray(request.waypoints, aim.depth())) return why;
  if (Refusal why = loop_astray(request.gains)) return why;
  return too_heavy(request, aim.depth());
}

}  // namespace

std::variant<Plan, PlanRefusal> plan_insertion(const InsertionRequest& request) {
  const Aim aim{request.X_SR.inverse() * request.target.p_ST};
  if (Refusal why = first_objection(request, aim)) return *why;

  const NominalModel model(request.weight, request.stage);
  const PlanLimits limits{
      .depth_max = aim.depth() + kDepthMargin, .v_max = Volts(0.0), .plausible = model.plausible_depths()};
  Plan plan{.target = request.target,
            .X_SR = request.X_SR,
            .registration_fre_mm = request.registration_fre_mm,
            .registration_tre_mm = request.registration_tre_mm,
            .target_depth = aim.depth(),
            .axis_offset = aim.offset(),
            .layers = request.layers,
            .steps = plan_steps(request.layers, aim.depth(), request.waypoints, request.staging, request.pace,
                                model),
            .limits = limits,
            .gains = request.gains,
            .tip_offset = request.tip_offset};
  for (const InsertionStep& step : plan.steps) plan.limits.v_max = std::max(plan.limits.v_max, step.v_max);
  seal(plan);
  return plan;
}

}  // namespace biopsy::planner
