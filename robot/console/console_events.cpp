#include "robot/console/console_events.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planner/plan/seal.hpp"
#include "robot/common/text/encoding.hpp"
#include "robot/console/server/picked_point.hpp"
#include "robot/procedure/images/anatomical_orientation.hpp"
#include "robot/report/plot/png.hpp"
#include "robot/report/procedure/labels.hpp"

namespace biopsy::robot {

namespace events = console::events;

std::array<double, 3> ras_of(const Point& p_S) {
  const Point ras = ras_from_lps(p_S);
  return {ras.x(), ras.y(), ras.z()};
}

events::Series series_of(const Volume& image) {
  events::Series series;
  const SeriesIdentity& identity = image.identity;
  series.series_uid = identity.series_uid;
  series.patient = identity.patient_name;
  series.patient_id = identity.patient_id;
  series.description = identity.description;
  series.modality = identity.modality;
  series.date = identity.date;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    series.size[axis] = static_cast<std::uint32_t>(image.grid.size[static_cast<int>(axis)]);
    series.spacing[axis] = image.grid.spacing_mm()[static_cast<int>(axis)];
  }
  series.ras_from_voxel = console::ras_from_voxel(image.grid);
  series.oblique = console::oblique_deg(image.grid);
  series.warnings = image.warnings;
  return series;
}

events::Planned planned_of(const PreparedCase& prepared, const std::optional<Point>& p_SE,
                           const std::optional<Point>& p_ST, bool confirmed) {
  events::Planned planned;
  if (p_SE) planned.entry.push_back({ras_of(*p_SE)});
  if (p_ST) planned.target.push_back({ras_of(*p_ST)});
  if (!p_SE || !p_ST) return planned;
  if (const auto* refused = std::get_if<PlanRefusal>(&prepared.plan)) {
    planned.refusal = refused->what;
    planned.remedy = refused->remedy;
    return planned;
  }
  const Plan& plan = std::get<Plan>(prepared.plan);
  const Direction axis_S = plan.X_SR.linear().col(2);
  planned.seal = hex(plan.seal);
  planned.confirmed = confirmed;
  planned.depth = plan.target_depth.value;
  planned.angle = std::asin(std::clamp(std::abs(axis_S.z()), 0.0, 1.0)) * 180.0 / std::numbers::pi;
  planned.axis_offset = plan.axis_offset.value;
  planned.depth_max = plan.limits.depth_max.value;
  planned.v_max = plan.limits.v_max.value * 1e-3;
  planned.side = anatomical_directions(-axis_S);
  for (const Layer& layer : plan.layers)
    planned.layers.push_back({layer.name, layer.from.value, layer.to.value});
  for (const InsertionStep& step : plan.steps)
    planned.stages.push_back(
        {step.depth.value, step.speed.value, step.v_max.value * 1e-3, step.image_confirms, step.why});
  return planned;
}

events::Checked checked_of(std::size_t step, const report::StepResult& result) {
  events::Checked checked;
  checked.stage = static_cast<std::uint32_t>(step);
  const DepthCheck& check = *result.check;
  checked.verdict = report::label(check.verdict);
  checked.reason = check.reason;
  checked.tip_found = check.tip_found;
  checked.planned = result.step.depth.value;
  checked.found = check.depth.value;
  checked.sigma = check.sigma.value;
  checked.error = check.tip_found ? check.depth.value - result.step.depth.value : 0.0;
  checked.lateral = check.lateral_mm;
  checked.lateral_sigma = check.lateral_sigma_mm;
  checked.angle = check.angle_deg;
  checked.angle_sigma = check.angle_sigma_deg;
  checked.confidence = check.registration_score;
  checked.before_png = base64(report::png_bytes(result.before));
  checked.after_png = base64(report::png_bytes(result.after));
  checked.width = static_cast<std::uint32_t>(result.after.width);
  checked.height = static_cast<std::uint32_t>(result.after.height);
  if (result.geometry) {
    checked.per_pixel = result.geometry->mm_per_pixel;
    checked.entry_px = {result.geometry->entry_x_px, result.geometry->entry_y_px};
    checked.axis = {result.geometry->axis_dx, result.geometry->axis_dy};
  }
  return checked;
}

}  // namespace biopsy::robot
