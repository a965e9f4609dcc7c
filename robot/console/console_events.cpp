#include "robot/console/console_events.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planner/plan/seal.hpp"
#include "robot/console/server/picked_point.hpp"
#include "robot/procedure/anatomical_orientation.hpp"
#include "robot/report/plot/png.hpp"

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
  events::Planned told;
  if (p_SE) told.entry.push_back({ras_of(*p_SE)});
  if (p_ST) told.target.push_back({ras_of(*p_ST)});
  if (!p_SE || !p_ST) return told;
  if (const auto* refused = std::get_if<PlanRefusal>(&prepared.plan)) {
    told.refusal = refused->what;
    told.remedy = refused->remedy;
    return told;
  }
  const Plan& plan = std::get<Plan>(prepared.plan);
  const Direction axis_S = plan.X_SR.linear().col(2);
  told.seal = planner::hex(plan.seal);
  told.confirmed = confirmed;
  told.depth = plan.target_depth.value;
  told.angle = std::asin(std::clamp(std::abs(axis_S.z()), 0.0, 1.0)) * 180.0 / std::numbers::pi;
  told.axis_offset = plan.axis_offset.value;
  told.depth_max = plan.limits.depth_max.value;
  told.v_max = plan.limits.v_max.value * 1e-3;
  told.side = side_letters(-axis_S);
  for (const Layer& layer : plan.layers)
    told.layers.push_back({layer.name, layer.from.value, layer.to.value});
  for (const InsertionStep& stage : plan.stages)
    told.stages.push_back(
        {stage.depth.value, stage.speed.value, stage.v_max.value * 1e-3, stage.image_confirms, stage.why});
  return told;
}

events::Checked checked_of(std::size_t stage, const report::StepResult& result) {
  events::Checked told;
  told.stage = static_cast<std::uint32_t>(stage);
  const DepthCheck& check = *result.check;
  told.verdict = check.verdict == DepthVerdict::Accept   ? "accept"
                 : check.verdict == DepthVerdict::Reject ? "reject"
                                                         : "unsure";
  told.reason = check.reason;
  told.tip_found = check.tip_found;
  told.planned = result.stage.depth.value;
  told.found = check.depth.value;
  told.sigma = check.sigma.value;
  told.error = check.tip_found ? check.depth.value - result.stage.depth.value : 0.0;
  told.confidence = check.registration_score;
  told.before_png = report::base64(report::png_bytes(result.before));
  told.after_png = report::base64(report::png_bytes(result.after));
  told.width = static_cast<std::uint32_t>(result.after.width);
  told.height = static_cast<std::uint32_t>(result.after.height);
  if (result.geometry) {
    told.per_pixel = result.geometry->mm_per_pixel;
    told.entry_px = {result.geometry->entry_x_px, result.geometry->entry_y_px};
    told.axis = {result.geometry->axis_dx, result.geometry->axis_dy};
  }
  return told;
}

}  // namespace biopsy::robot
