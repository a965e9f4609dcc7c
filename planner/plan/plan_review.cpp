#include "planner/plan/plan_review.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/plan/layers.hpp"
#include "planner/plan/plan_insertion.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "safety/types/limits.hpp"

namespace biopsy::planner {
namespace {

using Objection = std::optional<std::string>;

constexpr double kAgrees_mm = 0.01;
constexpr std::size_t kFaultMost = 200;  // a sentence about a layer, its name within

bool differ(Millimetres a, Millimetres b) {
  return !(std::abs((a - b).value) <= kAgrees_mm);
}

// Along the needle and beside it, from where its tip waits.
Point from_tip(const Plan& plan, const Point& p_S) {
  return plan.X_SR.inverse() * p_S;
}

double beside_mm(const Point& p_R) {
  return std::hypot(p_R.x(), p_R.y());
}

// A long name must not fill the terminal with lines that look like others.
std::string short_text(const std::string& text, std::size_t most = 64) {
  const std::string shown = plain(text);
  if (shown.size() <= most) return shown.empty() ? "(none)" : shown;
  return plain(shown.substr(0, most)) + fmt::format(" ... ({} bytes more)", shown.size() - most);
}

std::string ras_text(const Point& p_S) {
  const Point ras = ras_from_lps(p_S);
  return fmt::format("RAS {:.1f} {:.1f} {:.1f} mm", ras.x(), ras.y(), ras.z());
}

std::string registration_text(const Plan& plan) {
  const Point axis = ras_from_lps(plan.X_SR.linear().col(2));
  const std::string errors = plan.registration_fre_mm != 0.0
                                 ? fmt::format("FRE {:.2f} mm, TRE {:.2f} mm, as the console says",
                                               plan.registration_fre_mm, plan.registration_tre_mm)
                                 : "no errors measured: where the guide was aimed, or as it was given";
  return fmt::format("tip waits     {}, pointing to RAS {:.3f} {:.3f} {:.3f}\nregistration  {}\n",
                     ras_text(plan.X_SR.translation()), axis.x(), axis.y(), axis.z(), errors);
}

std::string layers_text(const std::vector<Layer>& layers) {
  std::string text;
  for (const Layer& layer : layers)
    text += fmt::format("layer         {:.2f} to {:.2f} mm: {}\n", layer.from.value, layer.to.value,
                        short_text(layer.name));
  return text;
}

std::string steps_text(const std::vector<InsertionStep>& steps) {
  std::string text;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const InsertionStep& step = steps[i];
    text +=
        fmt::format("step {:<2}       to {:.2f} mm at {:.2f} mm/s, {:.1f} s there, up to {:.1f} kV{}: {}\n",
                    i + 1, step.depth.value, step.speed.value, step.dwell.count(), step.v_max.value * 1e-3,
                    step.image_confirms ? ", then an image" : "", short_text(step.why));
  }
  return text;
}

std::string band_text(const DepthBand& band) {
  return fmt::format("{:.1f} to {:.1f} mm at {:.1f} kV", band.low.value, band.high.value,
                     band.drive.value * 1e-3);
}

std::string limits_text(const Plan& plan) {
  const std::vector<DepthBand>& bands = plan.limits.plausible;
  const std::string offset =
      plan.tip_offset ? fmt::format("{:.2f} mm +- {:.2f}, {} in {}", plan.tip_offset->value.value,
                                    plan.tip_offset->sigma.value, short_text(plan.tip_offset->needle),
                                    short_text(plan.tip_offset->sequence))
                      : "none: no image is accepted";
  return fmt::format(
      "gains         {:.4g} V/mm, {:.4g} V/mm at each tick\nplausible     {}\ntip offset    {}\n",
      plan.gains.proportional_V_per_mm, plan.gains.integral_V_per_mm_per_tick,
      bands.empty() ? "nothing" : band_text(bands.front()) + ", " + band_text(bands.back()), offset);
}

Objection misplaced(const Plan& plan) {
  const Eigen::Matrix3d rotation = plan.X_SR.linear();
  if (!(rotation * rotation.transpose()).isIdentity(1e-6) || !(rotation.determinant() > 0.0) ||
      !plan.X_SR.translation().allFinite())
    return "its robot-to-scanner transform is not a rotation and a translation";
  const Tolerances most;
  const double fre_mm = plan.registration_fre_mm, tre_mm = plan.registration_tre_mm;
  if (!(fre_mm >= 0.0 && fre_mm <= most.fre_mm && tre_mm >= 0.0 && tre_mm <= most.tre_mm))
    return fmt::format(
        "its registration errors, FRE {:.2f} and TRE {:.2f} mm, are not 0 to {:.1f} and 0 to {:.1f} mm",
        fre_mm, tre_mm, most.fre_mm, most.tre_mm);
  const double away_mm = (plan.X_SR.translation() - plan.target.p_SE).norm();
  if (!(away_mm <= kReviewedEntry.value))
    return fmt::format(
        "the tip waits {:.2f} mm from the entry, more than {:.1f} mm: choose the entry where the tip is",
        away_mm, kReviewedEntry.value);
  const Point p_RT = from_tip(plan, plan.target.p_ST);
  if (differ(Millimetres(p_RT.z()), plan.target_depth))
    return fmt::format("by its points the target is {:.2f} mm deep, and the plan says {:.2f} mm", p_RT.z(),
                       plan.target_depth.value);
  if (!(plan.target_depth >= kTargetMin))
    return fmt::format("the target is {:.2f} mm deep, nearer than {:.1f} mm", plan.target_depth.value,
                       kTargetMin.value);
  if (differ(Millimetres(beside_mm(p_RT)), plan.axis_offset) || !(plan.axis_offset <= most.axis_offset))
    return fmt::format("by its points the target is {:.2f} mm off the axis, and the plan says {:.2f} mm",
                       beside_mm(p_RT), plan.axis_offset.value);
  return {};
}

Objection stepping_astray(const Plan& plan) {
  Millimetres before{0.0};
  for (const InsertionStep& step : plan.steps) {
    if (!(step.depth > before)) return "its steps do not go deeper one by one";
    before = step.depth;
    if (!(step.speed.value > 0.0 && step.speed <= kSpeedMax))
      return fmt::format("a step is driven at {:.2f} mm/s; above 0 and up to {:.0f} are planned",
                         step.speed.value, kSpeedMax.value);
    if (!(step.dwell.count() > 0.0 && step.dwell <= kDwellMax))
      return fmt::format("a step waits {:.2f} s at its end; above 0 and up to {:.0f} are planned",
                         step.dwell.count(), kDwellMax.count());
    if (!(step.v_max.value > 0.0 && step.v_max <= from_mV(limits::kDriveMax_mV)))
      return fmt::format("a step may use {:.2f} kV; above 0 and up to {:.0f} are planned",
                         step.v_max.value * 1e-3, limits::kDriveMax_mV * 1e-6);
  }
  if (plan.steps.empty() || differ(plan.steps.back().depth, plan.target_depth))
    return "its last step does not end at the target";
  Volts most{0.0};
  for (const InsertionStep& step : plan.steps) most = std::max(most, step.v_max);
  if (plan.limits.v_max != most)
    return fmt::format("its highest drive is {:.2f} kV, and of its steps {:.2f}",
                       plan.limits.v_max.value * 1e-3, most.value * 1e-3);
  return {};
}

}  // namespace

std::string review_text(const Plan& plan) {
  const Point entry = from_tip(plan, plan.target.p_SE);
  return layers_text(plan.layers) + limits_text(plan) + registration_text(plan) + steps_text(plan.steps) +
         fmt::format(
             "patient       {}\nseries        {}\nentry         {}; the tip waits {:.2f} mm {} it, {:.2f} mm "
             "beside\n"
             "target        {}, {:.2f} mm from the entry\n"
             "needle goes   {:.2f} mm deep, to {:.2f} mm beside the target, never beyond {:.2f} mm\n",
             short_text(plan.target.patient_id), short_text(plan.target.series_uid),
             ras_text(plan.target.p_SE), std::abs(entry.z()), entry.z() < -0.005 ? "past" : "before",
             beside_mm(entry), ras_text(plan.target.p_ST), (plan.target.p_ST - plan.target.p_SE).norm(),
             plan.target_depth.value, plan.axis_offset.value, plan.limits.depth_max.value);
}

Objection objection_to(const Plan& plan) {
  if (plan.bench) return "it is a plan for the bench, not for a patient";
  if (Objection why = misplaced(plan)) return why;
  if (Objection why = stepping_astray(plan)) return why;
  if (differ(plan.limits.depth_max, plan.target_depth + from_um(limits::kDepthMargin_um)))
    return fmt::format("its depth limit of {:.2f} mm is not {:.2f} mm beyond the target",
                       plan.limits.depth_max.value, limits::kDepthMargin_um * 1e-3);
  if (!is_permitted(plan.gains)) return "its gains are not those of a loop that was tuned";
  if (const std::string fault = layer_fault(plan.layers); !fault.empty())
    return "of its layers: " + short_text(fault, kFaultMost);
  if (!(plan.layers.back().to > plan.target_depth)) return "its layers end before the target";
  return {};
}

}  // namespace biopsy::planner
