#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/files/file.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/gap/gap_labels.hpp"
#include "robot/report/gap/gap_report.hpp"
#include "robot/report/gap/gap_sections.hpp"
#include "robot/report/markup/html_markup.hpp"

namespace biopsy::report {
namespace {

std::string key_figures(const GapFinding& f) {
  double smallest = f.noise_floor;
  for (const double rmse : {f.rmse_before, f.rmse_after})
    if (std::isfinite(rmse) && rmse > 0) smallest = smallest > 0 ? std::min(smallest, rmse) : rmse;
  const int decimals = decimals_for(smallest);
  std::vector<std::pair<std::string, std::string>> figures{
      {"RMSE before", fixed(f.rmse_before, decimals, "mm")},
      {"RMSE after", fixed(f.rmse_after, decimals, "mm")},
      {f.noise_given ? "Noise floor, given" : "Noise floor, estimated",
       fixed(f.noise_floor, decimals, "mm")}};
  if (f.verdict != GapVerdict::NoGap) figures.emplace_back("Gap closed", percent_text(f.gap_closed));
  for (const FoundEffect& effect : f.effects)
    figures.emplace_back(
        f.effects.size() == 1 ? "Probability" : "Probability, " + escaped(readable_name(effect.name)),
        fixed(effect.probability, 2));
  figures.emplace_back("Evaluated on", counted(f.held_out_runs.size(), "held-out run"));
  return markup::key_figures(figures);
}

bool unsafe(const GapFinding& finding) {
  return std::any_of(finding.margins.begin(), finding.margins.end(),
                     [](const MarginChange& m) { return !m.ok; });
}

// Margins that change belong on the first sheet, whichever way they go.
std::string safety(const GapFinding& f) {
  if (unsafe(f)) {
    std::vector<std::string> lost;
    for (const MarginChange& m : f.margins)
      if (!m.ok) lost.push_back(margin_finding(m));
    return "<div class=\"finding\">" + markup::alarm("A safety margin does not hold with the new model") +
           markup::list(lost) + "</div>\n";
  }
  std::string text;
  if (!f.margins.empty())
    text = fmt::format("✓ Safety margins: all {} hold with {}.", f.margins.size(),
                       f.proposed ? "the proposed term" : "the new model");
  else if (f.verdict == GapVerdict::NoGap || f.force_drive)
    return {};
  else if (f.proposed)
    text = "▲ The model is unchanged, and the safety margins were not checked with the proposed term.";
  else if (f.verdict == GapVerdict::Unexplained)
    text = "▲ The model is unchanged: rehearsals with it do not include what is missing.";
  else
    text = "▲ The safety margins were not rechecked with the new model.";
  return "<p class=\"safety\">" + text + "</p>\n";
}

// What the examination of the recording found: a person decides before reading on.
std::string recording_section(const GapFinding& f) {
  std::vector<std::string> items;
  if (!f.comparison.reason.empty()) items.push_back("Chosen from the data: " + escaped(f.comparison.reason));
  for (const DataRemark& remark : f.data)
    items.push_back(escaped(remark.sentence +
                            (remark.runs.empty() ? "" : " (" + joined(remark.runs, ", ", " and ") + ")")));
  if (items.empty()) return {};
  return "<section>\n<h2>The recording</h2>\n" + markup::list(items) + "</section>\n";
}

// A run's name between quotes, its own quotes doubled.
std::string csv_cell(const std::string& text) {
  std::string out = "\"";
  for (const char c : plain(text)) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string verdict_section(const GapFinding& f) {
  std::string warnings;
  if (!f.warnings.empty())
    warnings = "<p class=\"safety\">▲ " + counted(f.warnings.size(), "warning") + " at the end.</p>\n";
  return fmt::format(
      "<section class=\"verdict gap{}\">\n<h2>Verdict <span class=\"badge {}\">{}</span></h2>\n<p "
      "class=\"sentence\">{}</p>\n{}{}{}</section>\n",
      unsafe(f) ? " unsafe" : "", label(f.verdict), badge_label(f.verdict), escaped(f.sentence),
      key_figures(f), safety(f), warnings);
}

}  // namespace

std::string gap_html(const GapFinding& f) {
  return markup::page(
      {.title = "Model gap – " + f.dataset, .heading = "Model gap: " + f.dataset, .style = markup::kGapStyle},
      verdict_section(f) + recording_section(f) + gap_where_section(f) + gap_overlay_section(f) +
          gap_closer_section(f) + gap_effects_section(f) + gap_proposed_section(f) +
          gap_parameters_section(f) + gap_shapes_section(f) + gap_candidates_section(f) +
          gap_doubts_section(f) + gap_regimes_section(f) + gap_fits_section(f) + gap_diff_section(f) +
          gap_margins_section(f) + gap_method_section(f));
}

std::string signals_csv(const GapFinding& f) {
  std::string out =
      fmt::format("run,role,time_s,{},measured_mm,before_mm,after_mm,residual_before_mm,residual_after_mm\n",
                  f.force_drive ? "force_N" : "voltage_V");
  for (const GapSignals& one : f.signals)
    for (std::size_t i = 0; i < one.time.size(); ++i)
      out += fmt::format("{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.4g},{:.4g}\n", csv_cell(one.run),
                         i < one.training_rows ? "train" : "test", one.time[i], one.input[i], one.measured[i],
                         one.before[i], one.after[i], one.measured[i] - one.before[i],
                         one.measured[i] - one.after[i]);
  return out;
}

void save_gap(const GapFinding& f, const std::filesystem::path& folder) {
  atomic_write(folder / "model.toml", f.model_after);
  if (f.proposed) atomic_write(folder / "proposed.toml", f.model_proposed);
  atomic_write(folder / "report.html", gap_html(f));
  atomic_write(folder / "signals.csv", signals_csv(f));
  atomic_write(folder / "gap.json", gap_json(f));  // last: its presence means that the rest is there
}

}  // namespace biopsy::report
