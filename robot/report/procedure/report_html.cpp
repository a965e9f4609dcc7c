#include <fmt/format.h>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/report/markup/html_markup.hpp"
#include "robot/report/procedure/html_sections.hpp"
#include "robot/report/procedure/labels.hpp"
#include "robot/report/procedure/report.hpp"
#include "robot/report/procedure/verdict.hpp"

namespace biopsy::report {
namespace {

constexpr const char* kSimulatedBanner =
    "<p class=\"simulated\"><strong>SIMULATED</strong> Rehearsal against a simulated actuator, tissue and "
    "scanner. No needle moved.</p>\n<div class=\"watermark\" aria-hidden=\"true\">SIMULATED</div>\n";
constexpr const char* kSimulatedStyle =
    "@page { @top-center { content: \"SIMULATED\"; font-weight: bold; } }\n";

const char* shape(Outcome outcome) {
  switch (outcome) {
    case Outcome::Completed:
      return "✓";
    case Outcome::Refused:
      return "▲";
    case Outcome::Stopped:
      return "■";
  }
  return "";
}

std::string key_figures(const RunRecord& record) {
  if (record.outcome == Outcome::Refused || record.samples.empty()) return {};
  const double target = record.plan ? record.plan->target_depth.value : kUnknown;
  return markup::key_figures(
      {{"Target depth", fixed(target, 2, "mm")},
       {"Depth by laser", fixed(record.final_depth_mm, 3, "mm")},
       {"Depth by image", fixed(record.image_depth_mm, 2, "mm")},
       {"Image, standard deviation", fixed(record.image_depth_sigma_mm, 2, "mm")},
       {"Layer at the tip", record.layer_at_tip.empty() ? "–" : record.layer_at_tip},
       {"Laser − target", fixed(record.final_depth_mm - target, 3, "mm")},
       {"Image − laser", fixed(record.image_depth_mm - record.final_depth_mm, 3, "mm")},
       {"RMSE, settled", fixed(record.rmse_settled_mm, 3, "mm")},
       {"RMSE, whole run", fixed(record.rmse_all_mm, 3, "mm")},
       {"Overshoot", fixed(record.overshoot_mm, 3, "mm")},
       {"Peak drive", fixed(record.peak_kV, 2, "kV")},
       {record.simulated ? "Simulated time" : "Duration", fixed(record.simulated_s, 1, "s")}});
}

// A completed run whose last image did not confirm it must not look like good news.
std::string unconfirmed(const RunRecord& record) {
  const DepthCheck* check = last_check(record);
  if (!check || check->verdict == DepthVerdict::Accept) return {};
  return markup::alarm("Last depth check: " + std::string(label(check->verdict)) + ". " + check->reason);
}

std::string verdict_section(const RunRecord& record) {
  const std::string alarm = unconfirmed(record);
  return fmt::format(
      "<section class=\"verdict {}{}\">\n<h2>Verdict</h2>\n<p><span class=\"shape\" "
      "aria-hidden=\"true\">{}</span>{}</p>\n{}{}</section>\n",
      label(record.outcome), alarm.empty() ? "" : " doubted", shape(record.outcome),
      escaped(verdict_sentence(record)), alarm, key_figures(record));
}

}  // namespace

std::string report_html(const RunRecord& record) {
  markup::Page page{.title = (record.simulated ? "SIMULATED – " : "") + record.title,
                    .heading = record.title,
                    .style = record.simulated ? kSimulatedStyle : "",
                    .banner = record.simulated ? kSimulatedBanner : "",
                    .embedded_pictures = true};
  return markup::page(page, verdict_section(record) + patient_section(record) + plan_section(record) +
                                images_section(record) + figure_section(record) + steps_section(record) +
                                checks_section(record) + limits_section(record) + trips_section(record) +
                                faults_section(record) + provenance_section(record));
}

}  // namespace biopsy::report
