#include "robot/report/gap/gap_html.hpp"

#include <algorithm>
#include <cmath>

#include "robot/common/number_text.hpp"
#include "robot/common/sanitize_text.hpp"
#include "robot/report/gap/gap_labels.hpp"
#include "robot/report/gap/gap_sections.hpp"
#include "robot/report/plot/html_markup.hpp"
#include "robot/report/procedure/html_sections.hpp"

namespace biopsy::report {
namespace {

std::string key_figures(const GapFinding& f) {
  double smallest = f.noise_floor;
  for (const double rmse : {f.rmse_before, f.rmse_after})
    if (std::isfinite(rmse) && rmse > 0) smallest = smallest > 0 ? std::min(smallest, rmse) : rmse;
  const int decimals = decimals_for(smallest);
  const bool gap = f.verdict != GapVerdict::NoGap;  // the share closed of nothing is no figure
  std::string html = "<dl class=\"figures\">\n" +
                     markup::key_figure("RMSE before", fixed(f.rmse_before, decimals, "mm")) +
                     markup::key_figure("RMSE after", fixed(f.rmse_after, decimals, "mm")) +
                     markup::key_figure(f.noise_given ? "Noise floor, given" : "Noise floor, estimated",
                                        fixed(f.noise_floor, decimals, "mm"));
  if (gap) html += markup::key_figure("Gap closed", percent_text(f.gap_closed));
  for (const FoundEffect& effect : f.effects)
    html += markup::key_figure(
        f.effects.size() == 1 ? "Probability" : "Probability, " + escaped(name_words(effect.name)),
        fixed(effect.probability, 2));
  return html +
         markup::key_figure("Judged on", std::to_string(f.held_out_runs.size()) + " held-out run" +
                                             (f.held_out_runs.size() == 1 ? "" : "s")) +
         "</dl>\n";
}

bool unsafe(const GapFinding& finding) {
  return std::any_of(finding.margins.begin(), finding.margins.end(),
                     [](const MarginChange& m) { return !m.ok; });
}

// What the new truth does to the safety margins belongs on the first sheet, whichever way it goes.
std::string safety(const GapFinding& f) {
  if (unsafe(f)) {
    std::string html =
        "<div class=\"finding\"><p class=\"alarm\">■ A safety margin does not hold with the new "
        "model</p>\n<ul>\n";
    for (const MarginChange& m : f.margins)
      if (!m.ok) html += "<li>" + escaped(margin_finding(m)) + "</li>\n";
    return html + "</ul></div>\n";
  }
  if (!f.margins.empty())
    return "<p class=\"safety\">✓ Safety margins: all " + std::to_string(f.margins.size()) +
           " hold with the new model.</p>\n";
  if (f.verdict == GapVerdict::NoGap || f.force_drive) return {};
  if (f.verdict == GapVerdict::Unexplained)
    return "<p class=\"safety\">▲ The model stays as it was: rehearsals with it do not know what is "
           "missing.</p>\n";
  return "<p class=\"safety\">▲ The safety margins were not rechecked with the new model.</p>\n";
}

std::string verdict_section(const GapFinding& f) {
  const std::string verdict(word(f.verdict));
  return "<section class=\"verdict gap" + std::string(unsafe(f) ? " unsafe" : "") +
         "\">\n<h2>Verdict <span class=\"badge " + verdict + "\">" + std::string(badge_word(f.verdict)) +
         "</span></h2>\n<p class=\"sentence\">" + escaped(f.sentence) + "</p>\n" + key_figures(f) +
         safety(f) +
         (f.warnings.empty()
              ? ""
              : "<p class=\"safety\">▲ " + std::to_string(f.warnings.size()) +
                    (f.warnings.size() == 1 ? " warning" : " warnings") + " at the end.</p>\n") +
         "</section>\n";
}

}  // namespace

std::string gap_html(const GapFinding& f) {
  return markup::page_head("Model gap – " + f.dataset, markup::kGapStyle) +
         "<body>\n<main>\n<h1>Model gap: " + escaped(f.dataset) + "</h1>\n" + verdict_section(f) +
         gap_where_section(f) + gap_overlay_section(f) + gap_closer_section(f) + gap_effects_section(f) +
         gap_parameters_section(f) + gap_shapes_section(f) + gap_candidates_section(f) +
         gap_doubts_section(f) + gap_regimes_section(f) + gap_diff_section(f) + gap_margins_section(f) +
         gap_method_section(f) + "</main>\n</body>\n</html>\n";
}

}  // namespace biopsy::report
