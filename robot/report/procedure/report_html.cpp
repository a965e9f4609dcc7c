#include "robot/report/procedure/report_html.hpp"

#include "robot/common/files/file.hpp"
#include "robot/common/number_text.hpp"
#include "robot/common/sanitize_text.hpp"
#include "robot/report/plot/html_markup.hpp"
#include "robot/report/procedure/html_sections.hpp"
#include "robot/report/procedure/labels.hpp"
#include "robot/report/procedure/verdict.hpp"

namespace biopsy::report {
namespace {

std::string head(const RunRecord& record) {
  return markup::page_head(
      (record.simulated ? "SIMULATED – " : "") + record.title,
      record.simulated ? "@page { @top-center { content: \"SIMULATED\"; font-weight: bold; } }\n" : "",
      markup::Pictures::Embedded);
}

std::string simulated_banner(const RunRecord& record) {
  if (!record.simulated) return {};
  return "<p class=\"simulated\"><strong>SIMULATED</strong> Rehearsal against a simulated actuator, tissue "
         "and scanner. "
         "No needle moved.</p>\n<div class=\"watermark\" aria-hidden=\"true\">SIMULATED</div>\n";
}

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
  return "<dl class=\"figures\">\n" + markup::key_figure("Target depth", fixed(target, 2, "mm")) +
         markup::key_figure("Depth by laser", fixed(record.final_depth_mm, 3, "mm")) +
         markup::key_figure("Depth by image", fixed(record.image_depth_mm, 2, "mm")) +
         markup::key_figure("Image, standard deviation", fixed(record.image_depth_sigma_mm, 2, "mm")) +
         markup::key_figure("Layer at the tip", record.layer_at_tip.empty() ? "–" : record.layer_at_tip) +
         markup::key_figure("Laser − target", fixed(record.final_depth_mm - target, 3, "mm")) +
         markup::key_figure("Image − laser", fixed(record.image_depth_mm - record.final_depth_mm, 3, "mm")) +
         markup::key_figure("RMSE, settled", fixed(record.rmse_settled_mm, 3, "mm")) +
         markup::key_figure("RMSE, whole run", fixed(record.rmse_all_mm, 3, "mm")) +
         markup::key_figure("Overshoot", fixed(record.overshoot_mm, 3, "mm")) +
         markup::key_figure("Peak drive", fixed(record.peak_kV, 2, "kV")) +
         markup::key_figure(record.simulated ? "Simulated time" : "Duration",
                            fixed(record.simulated_s, 1, "s")) +
         "</dl>\n";
}

// A completed run whose last image did not confirm it must not look like good news.
std::string doubt(const RunRecord& record) {
  const DepthCheck* check = last_check(record);
  if (!check || check->verdict == DepthVerdict::Accept) return {};
  return "<p class=\"alarm\">■ The last image check says " + std::string(word(check->verdict)) + ": " +
         escaped(check->reason) + "</p>\n";
}

std::string verdict_section(const RunRecord& record) {
  const std::string doubts = doubt(record);
  return "<section class=\"verdict " + std::string(word(record.outcome)) +
         (doubts.empty() ? "" : " doubted") +
         "\">\n<h2>Verdict</h2>\n<p><span class=\"shape\" aria-hidden=\"true\">" + shape(record.outcome) +
         "</span>" + escaped(verdict_sentence(record)) + "</p>\n" + doubts + key_figures(record) +
         "</section>\n";
}

}  // namespace

std::string report_html(const RunRecord& record) {
  return head(record) + "<body>\n" + simulated_banner(record) + "<main>\n<h1>" + escaped(record.title) +
         "</h1>\n" + verdict_section(record) + patient_section(record) + plan_section(record) +
         images_section(record) + figure_section(record) + stages_section(record) + checks_section(record) +
         limits_section(record) + trips_section(record) + provenance_section(record) +
         "</main>\n</body>\n</html>\n";
}

void save_report_html(const RunRecord& record, const std::filesystem::path& path) {
  atomic_write(path, report_html(record));
}

}  // namespace biopsy::report
