#include <fmt/format.h>

#include <algorithm>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/markup/html_markup.hpp"
#include "robot/report/plot/needle_overlay.hpp"
#include "robot/report/plot/plane_overlay.hpp"
#include "robot/report/plot/png.hpp"
#include "robot/report/procedure/html_sections.hpp"
#include "robot/report/procedure/labels.hpp"

namespace biopsy::report {
namespace {

using markup::facts, markup::figure, markup::paragraph, markup::section;

std::string image(const Picture& picture, const std::string& alt) {
  return "<img src=\"" + png_data_uri(picture) + "\" alt=\"" + escaped(alt) + "\" />";
}

OverlayText overlay_text(const RunRecord& record, std::string title) {
  return {std::move(title), record.simulated ? "SIMULATED" : ""};
}

std::string planning_picture(const RunRecord& record) {
  const Picture& slice = record.planning_slice;
  if (slice.width == 0) return {};
  if (!record.planning_geometry || !record.plan)
    return figure(image(slice, "Planning slice through the needle"), "Slice through the needle.");
  return figure(planning_overlay(slice, *record.planning_geometry, *record.plan,
                                 overlay_text(record, "Planning slice with entry, path, layers and target")),
                "Left: slice through the needle. Right: the dashed square enlarged. Cyan ring: entry; "
                "yellow: path, with a tick at each layer boundary; magenta cross: target.");
}

std::string plane_pictures(const RunRecord& record) {
  std::vector<std::string> planes;
  for (const BodyPlane& plane : record.planes) planes.push_back(plane_overlay(plane, record.simulated));
  if (planes.empty()) return {};
  return "<h3>Planes through the target</h3>\n" + markup::panels(planes) +
         paragraph(
             "Radiological convention: the patient's right is at the left of axial and coronal pictures. "
             "Dashed "
             "lines cross at the target; yellow: the needle's path, as seen from the side.");
}

std::string point(const Point& p) {
  return fmt::format("{}, {}, {} mm", fixed(p.x(), 1), fixed(p.y(), 1), fixed(p.z(), 1));
}

std::string plan_facts(const Plan& plan, const std::string& registration) {
  std::vector<std::string> layers;
  for (const Layer& layer : plan.layers)
    layers.push_back(layer.name + " " + fixed(layer.from.value, 2) + " to " + fixed(layer.to.value, 2, "mm"));
  const bool registered = plan.registration_fre_mm > 0;
  const bool assumed = registration == "assumed";
  return facts(
      {{"Target depth", fixed(plan.target_depth.value, 2, "mm")},
       {"Deepest allowed", fixed(plan.limits.depth_max.value, 2, "mm")},
       {"Gains of the loop", fixed(1e-3 * plan.gains.proportional_V_per_mm, 2, "kV/mm") + ", " +
                                 fixed(plan.gains.integral_V_per_mm_per_tick, 2, "kV/(mm s)")},
       {"Tip offset",
        plan.tip_offset ? fmt::format("{} ± {} of {} in sequence {}", fixed(plan.tip_offset->value.value, 2),
                                      fixed(plan.tip_offset->sigma.value, 2, "mm"), plan.tip_offset->needle,
                                      plan.tip_offset->sequence)
                        : "not calibrated: no image will be accepted"},
       {"Target beside the axis", fixed(plan.axis_offset.value, 2, "mm")},
       {"Entry, R, A, S", point(ras_from_lps(plan.target.p_SE))},
       {"Target, R, A, S", point(ras_from_lps(plan.target.p_ST))},
       {"Layers along the path", joined(layers, "; ")},
       {"Robot to scanner", registered ? "registered: FRE " + fixed(plan.registration_fre_mm, 2, "mm") +
                                             ", expected error at the target " +
                                             fixed(plan.registration_tre_mm, 2, "mm")
                            : assumed ? "assumed: aimed at the entry along the path"
                                      : "transform as given"}});
}

// All pictures of a step have one scale.
Millimetres depth_shown(const StepResult& step) {
  return step.check && step.check->tip_found ? std::max(step.step.depth, step.check->depth) : step.step.depth;
}

std::string step_picture(const RunRecord& record, const StepResult& step, bool after,
                         const std::string& title) {
  const Picture& slice = after ? step.after : step.before;
  if (slice.width == 0) return {};
  if (!step.geometry) return figure(image(slice, title), escaped(title) + ".");
  const TipDepths depths{step.step.depth, depth_shown(step), after && step.check ? &*step.check : nullptr};
  return figure(tip_overlay(slice, *step.geometry, depths, overlay_text(record, title)),
                escaped(title) + ".");
}

std::string step_pictures(const RunRecord& record, std::size_t index) {
  const StepResult& step = record.steps[index];
  if (step.before.width == 0 && step.after.width == 0) return {};
  std::string html = fmt::format("<h3>Step {}: {} to {}</h3>\n<div class=\"pair\">\n", index + 1,
                                 label(step.step.kind), fixed(step.step.depth.value, 2, "mm"));
  html += step_picture(record, step, false, fmt::format("Step {}, before", index + 1));
  html += step_picture(record, step, true, fmt::format("Step {}, after, registered to before", index + 1));
  html += "</div>\n";
  const std::string title = fmt::format("Step {}, after minus before", index + 1);
  if (const Picture difference = difference_of(step.before, step.after);
      difference.width > 0 && step.geometry)
    html += figure(tip_overlay(difference, *step.geometry,
                               {step.step.depth, depth_shown(step), step.check ? &*step.check : nullptr},
                               overlay_text(record, title)),
                   escaped(title) +
                       ": grey where nothing changed, dark where signal was lost. White bar: the tip "
                       "within two standard deviations.");
  if (step.check) html += paragraph(step.check->reason);
  return html;
}

}  // namespace

std::string plan_section(const RunRecord& record) {
  std::string html;
  if (record.plan && record.registration == "assumed")
    html = markup::alarm(
        "The robot's place in the scanner is assumed, not registered: give fiducials or a transform "
        "before a needle is moved by this plan.");
  return section("Plan", html + planning_picture(record) + plane_pictures(record) +
                             (record.plan ? plan_facts(*record.plan, record.registration) : ""));
}

std::string figure_section(const RunRecord& record) {
  return section("Run", figure(run_figure(record),
                               "Depth against plan, drive voltage with the permit's envelope, and the "
                               "supervisor's states. Shaded: the steps. Dotted: image taken. Dashed level "
                               "lines: layer boundaries and target."));
}

std::string images_section(const RunRecord& record) {
  std::string content;
  for (std::size_t i = 0; i < record.steps.size(); ++i) content += step_pictures(record, i);
  if (!content.empty())
    content += paragraph(
        "Cyan ring: entry; magenta cross: planned depth; white dot: tip as found in the image, with a bar of "
        "± 2 standard deviations; yellow strokes: end of the void, which goes on beyond the tip by the "
        "needle's "
        "offset.");
  return section("Images before and after", content);
}

}  // namespace biopsy::report
