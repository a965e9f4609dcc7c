#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/text/encoding.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/report/markup/html_markup.hpp"
#include "robot/report/procedure/html_sections.hpp"
#include "robot/report/procedure/labels.hpp"
#include "robot/report/procedure/verdict.hpp"

namespace biopsy::report {
namespace {

using markup::facts, markup::number_cell, markup::row, markup::section, markup::table, markup::text_cell;

std::string step_row(const StepResult& result, std::size_t number) {
  const InsertionStep& step = result.step;
  return row({number_cell(std::to_string(number)),
              fmt::format("<td><strong>{}</strong><br />{}</td>", label(step.kind), escaped(step.why)),
              number_cell(step.depth.value, 2), number_cell(step.speed.value, 2),
              number_cell(step.v_max.value * 1e-3, 2),
              result.reached ? number_cell(result.reached_s, 2) : number_cell("not reached"),
              number_cell(result.depth_mm, 3), number_cell(result.rmse_settled_mm, 3),
              number_cell(result.overshoot_mm, 3), text_cell(result.layer_at_tip)});
}

std::string verdict_cell(const DepthCheck& check) {
  switch (check.verdict) {
    case DepthVerdict::Accept:
      return "<td class=\"level\">✓ accept</td>";
    case DepthVerdict::Unsure:
      return "<td class=\"level\"><strong>? unsure</strong></td>";
    case DepthVerdict::Reject:
      return "<td class=\"level alarm\">■ reject</td>";
  }
  return text_cell("");
}

std::string triple_cell(const double (&values)[3]) {
  return "<td class=\"level\">" + fixed(values[0], 1) + ", " + fixed(values[1], 1) + ", " +
         fixed(values[2], 1) + "</td>";
}

std::string with_sigma(const DepthCheck& check, double value, double sigma) {
  return check.tip_found ? number_cell(fixed(value, 2) + " ± " + fixed(sigma, 2)) : number_cell(kUnknown, 2);
}

std::string check_row(const StepResult& result, std::size_t number) {
  const DepthCheck& check = *result.check;
  const double depth = check.tip_found ? check.depth.value : kUnknown;
  const std::string switching =
      result.hv_switching_during_image ? " The drive switched, or the needle slipped, in this image." : "";
  return row({number_cell(std::to_string(number)), verdict_cell(check), number_cell(depth, 2),
              number_cell(check.tip_found ? check.sigma.value : kUnknown, 2),
              number_cell(depth - result.depth_mm, 2),
              with_sigma(check, check.lateral_mm, check.lateral_sigma_mm),
              with_sigma(check, check.angle_deg, check.angle_sigma_deg), triple_cell(check.shift_mm),
              triple_cell(check.rotation_deg), number_cell(check.registration_score, 3),
              number_cell(check.contrast_to_noise, 1), text_cell(check.reason + switching)});
}

// Grey up to the value, a tick at the limit; red and beyond the tick where the limit was passed.
std::string limit_bar(double percent) {
  constexpr double kFull = 200.0, kWidest = 110.0;
  const double shown = std::isfinite(percent) ? std::clamp(percent, 0.0, kWidest) : 0.0;
  return fmt::format(
      R"(<svg class="bar" viewBox="0 0 222 18" aria-hidden="true"><rect x="0" y="4" width="{0:.0f}" height="10" )"
      R"(fill="#ffffff" stroke="#8b959d"/><rect x="0" y="4" width="{1:.1f}" height="10" fill="{2}"/>)"
      R"(<path d="M{0:.0f} 0v18" stroke="#1d262e" stroke-width="3"/></svg>)",
      kFull, kFull * shown / 100.0, percent > 100.0 ? "#b00020" : "#55636f");
}

std::string limit_row(const LimitUse& use) {
  const double percent = used_percent(use);
  const std::string note = percent > 100.0   ? "<span class=\"alarm\">■ beyond the limit</span>"
                           : percent >= 90.0 ? "<strong>▲ close to the limit</strong>"
                                             : "";
  return row({text_cell(use.name), number_cell(use.used, 2), number_cell(use.limit, 2), text_cell(use.unit),
              "<td>" + limit_bar(percent) + "</td>", number_cell(fixed(percent, 0, "%")),
              "<td>" + note + "</td>"});
}

}  // namespace

std::string patient_section(const RunRecord& record) {
  const SeriesIdentity& series = record.series;
  std::string html = facts({{"Patient", person_name(series.patient_name)},
                            {"Patient ID", series.patient_id},
                            {"Series", series.description},
                            {"Modality", series.modality},
                            {"Date", series.date},
                            {"Series UID", series.series_uid},
                            {"Study UID", series.study_uid},
                            {"Read from", record.image_source}});
  if (!record.image_warnings.empty())
    html += "<h3>▲ Warnings from reading the image</h3>\n" + markup::list(record.image_warnings);
  return section("Patient and image", html);
}

std::string steps_section(const RunRecord& record) {
  const std::vector<StepResult> steps = driven_or_planned_steps(record);
  if (steps.empty()) return {};
  std::string rows;
  for (std::size_t i = 0; i < steps.size(); ++i) rows += step_row(steps[i], i + 1);
  return section(
      "Steps",
      table("RMSE: depth against the step's target once settled. Overshoot: beyond that target.",
            {">No.", "Step", ">Planned<br />mm", ">Speed<br />mm/s", ">Drive limit<br />kV",
             ">Reached<br />s", ">Laser<br />mm", ">RMSE<br />mm", ">Overshoot<br />mm", "Layer at tip"},
            rows));
}

std::string checks_section(const RunRecord& record) {
  std::string rows;
  for (std::size_t i = 0; i < record.steps.size(); ++i)
    if (record.steps[i].check) rows += check_row(record.steps[i], i + 1);
  if (rows.empty()) return {};
  return section(
      "Image checks",
      table("Depth of the tip found in the image alone; the check does not use the laser. Shift and rotation "
            "of the patient from before to after, axes L, P, S.",
            {">Step", "Verdict", ">Depth<br />mm", ">Std. dev.<br />mm", ">Image − laser<br />mm",
             ">Beside the axis<br />mm", ">Angle<br />deg", "Shift<br />mm", "Rotation<br />deg",
             ">Registration<br />score", ">Contrast<br />to noise", "Reason"},
            rows));
}

std::string limits_section(const RunRecord& record) {
  if (record.limits.empty()) return {};
  std::string rows;
  for (const LimitUse& use : record.limits) rows += limit_row(use);
  return section("Limits and how much was used",
                 table("The tick at the end of a bar is the hard limit.",
                       {"Limit", ">Used", ">Limit", "Unit", "Share", ">%", "Note"}, rows));
}

std::string trips_section(const RunRecord& record) {
  if (record.trips.empty()) return section("Trips", markup::paragraph("None."));
  std::string rows;
  for (std::size_t i = 0; i < record.trips.size(); ++i) {
    const Trip& trip = record.trips[i];
    rows += row({fmt::format("<td class=\"n alarm\">{}</td>", i + 1), number_cell(trip.time_s, 3),
                 text_cell(std::string(label(trip.stop))), text_cell(trip.reason)});
  }
  return section(
      "Trips", table("Stop categories as in IEC 60204-1.", {">No.", ">Time<br />s", "Stop", "Reason"}, rows));
}

std::string faults_section(const RunRecord& record) {
  std::string rows;
  for (const FaultResult& fault : record.faults)
    rows += row({text_cell(fault.signal), text_cell(fault.kind), number_cell(fault.began_s, 3),
                 text_cell(fault.detected_by.empty() ? "nothing" : fault.detected_by),
                 number_cell(fault.detected_after_ms, 0)});
  if (rows.empty()) return {};
  return section("Faults put in",
                 markup::paragraph("Deepest true tip: " + fixed(record.true_depth_max_mm, 3, "mm") + ".") +
                     table("Put into the simulated stage, its links or its panel.",
                           {"Signal", "Kind", ">Began<br />s", "Detected by", ">After<br />ms"}, rows));
}

std::string provenance_section(const RunRecord& record) {
  std::vector<std::pair<std::string, std::string>> rows{{"Seed", std::to_string(record.seed)}};
  if (record.plan)
    rows.emplace_back("Plan seal, SHA-256", fmt::format("{:02x}", fmt::join(record.plan->seal, "")));
  rows.insert(rows.end(), record.provenance.begin(), record.provenance.end());
  return section("How to reproduce this report", facts(rows));
}

}  // namespace biopsy::report
