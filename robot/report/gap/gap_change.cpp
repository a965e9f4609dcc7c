#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/gap/gap_diff.hpp"
#include "robot/report/gap/gap_labels.hpp"
#include "robot/report/gap/gap_sections.hpp"
#include "robot/report/markup/html_markup.hpp"

namespace biopsy::report {
namespace {

using namespace markup;

constexpr std::size_t kContext = 3;  // unchanged lines shown around a change

std::string estimate_row(const GapEstimate& p) {
  const ReadableQuantity quantity = effect_quantity(p.name);
  return row({name_cell(quantity.label, p.name), number_cell(estimate_text(p.value, p.std)),
              number_cell(interval_text(p.value, p.std)), text_cell(quantity.unit)});
}

std::string effect_block(const FoundEffect& effect) {
  std::string rows;
  for (const GapEstimate& p : effect.parameters) rows += estimate_row(p);
  std::string text = effect.sentence;
  if (std::isfinite(effect.share_explained))
    text += fmt::format(
        "{}It explained {} of the held-out excess error that was left when it entered; "
        "probability {}.",
        text.empty() ? "" : " ", percent_text(effect.share_explained), fixed(effect.probability, 2));
  std::string html = fmt::format("<h3>{} <code>{}</code></h3>\n{}", escaped(readable_name(effect.name)),
                                 escaped(effect.name), paragraph(text));
  if (!rows.empty())
    html += table("Value ± one standard deviation; the interval is the value ± 1.96 of them.",
                  {"Parameter", ">Value", ">95 % interval", "Unit"}, rows);
  return html;
}

std::string changed_row(const ChangedParameter& p) {
  const ReadableQuantity quantity = baseline_quantity(p.name);
  const double unit = quantity.per_file_unit, std = p.std * unit;
  const double change = p.before != 0 ? (p.after - p.before) / p.before : std::nan("");
  const std::string relative =
      std::isfinite(change) ? std::string(change > 0 ? "+" : "") + fixed(100 * change, 1, "%") : "–";
  return row({name_cell(quantity.label, p.name), number_cell(estimate_text(p.before * unit, 0)),
              number_cell(estimate_text(p.after * unit, std)),
              number_cell(interval_text(p.after * unit, std)), text_cell(quantity.unit),
              number_cell(relative), number_cell(std::abs(p.after - p.before) / p.std, 1)});
}

const char* sign(DiffKind kind) {
  switch (kind) {
    case DiffKind::Same:
      return "<span>  ";
    case DiffKind::Removed:
      return "<span class=\"removed\">− ";
    case DiffKind::Added:
      return "<span class=\"added\">+ ";
  }
  return "<span>  ";
}

// Which lines to print: every change and its surroundings.
std::vector<bool> shown_lines(const std::vector<DiffLine>& diff) {
  std::vector<bool> shown(diff.size(), false);
  for (std::size_t i = 0; i < diff.size(); ++i) {
    if (diff[i].kind == DiffKind::Same) continue;
    const std::size_t from = i - std::min(i, kContext), to = std::min(i + kContext, diff.size() - 1);
    std::fill(shown.begin() + static_cast<std::ptrdiff_t>(from),
              shown.begin() + static_cast<std::ptrdiff_t>(to) + 1, true);
  }
  return shown;
}

std::string diff_html(const std::vector<DiffLine>& diff) {
  const std::vector<bool> shown = shown_lines(diff);
  std::string html = "<pre class=\"diff\">";
  for (std::size_t i = 0; i < diff.size();) {
    if (shown[i]) {
      html += sign(diff[i].kind) + escaped(diff[i].text) + "</span>";
      ++i;
      continue;
    }
    std::size_t skipped = 0;
    for (; i < diff.size() && !shown[i]; ++i) ++skipped;
    html += "<span class=\"skipped\">  … " + counted(skipped, "unchanged line") + "</span>";
  }
  return html + "</pre>\n";
}

std::string margin_row(const MarginChange& m) {
  const int decimals = decimals_for(std::abs(m.limit) / 10);
  return row(
      {text_cell(m.plan), text_cell(readable_name(m.quantity)), number_cell(m.limit, decimals),
       number_cell(m.before, decimals), number_cell(percent_text(m.before / m.limit)),
       number_cell(m.after, decimals), number_cell(percent_text(m.after / m.limit)), text_cell(m.unit),
       m.ok ? "<td class=\"level\">✓ holds</td>" : "<td class=\"level alarm\">■ beyond the limit</td>"});
}

std::string name_list(const std::vector<std::string>& names) {
  return names.empty() ? "none" : joined(names);
}

}  // namespace

std::string margin_finding(const MarginChange& m) {
  const int decimals = decimals_for(std::abs(m.limit) / 10);
  return fmt::format(
      "Plan {}: {} reaches {} with the new model; the limit is {}, the old model predicted {}.", m.plan,
      readable_name(m.quantity), fixed(m.after, decimals, m.unit), fixed(m.limit, decimals, m.unit),
      fixed(m.before, decimals, m.unit));
}

std::string gap_effects_section(const GapFinding& finding) {
  std::string html;
  for (const FoundEffect& effect : finding.effects) html += effect_block(effect);
  return section(finding.effects.size() > 1 ? "Effects found" : "Effect found", html);
}

std::string gap_parameters_section(const GapFinding& finding) {
  if (finding.parameters_changed.empty()) return {};
  std::string rows;
  for (const ChangedParameter& p : finding.parameters_changed) rows += changed_row(p);
  return section(
      "Baseline parameters that changed",
      table("The last column is the change in standard deviations of the new value.",
            {"Parameter", ">Before", ">After", ">95 % interval", "Unit", ">Change", ">Std. devs."}, rows));
}

std::string gap_diff_section(const GapFinding& finding) {
  if (finding.model_before.empty() && finding.model_after.empty()) return {};
  const std::vector<DiffLine> diff =
      line_diff(finding.model_before, finding.proposed ? finding.model_proposed : finding.model_after);
  const bool same =
      std::all_of(diff.begin(), diff.end(), [](const DiffLine& l) { return l.kind == DiffKind::Same; });
  return section(finding.proposed ? "The change that --accept makes" : "The change to the model",
                 same ? paragraph("The model is unchanged.") : diff_html(diff));
}

std::string gap_margins_section(const GapFinding& finding) {
  if (finding.margins.empty()) return {};
  std::string rows;
  for (const MarginChange& m : finding.margins) rows += margin_row(m);
  return section(
      "Effect on the safety margins",
      table("Dry-runs of the reference plans with the old and the new model.",
            {"Plan", "Quantity", ">Limit", ">Used before", ">%", ">Used now", ">%", "Unit", "Verdict"},
            rows));
}

std::string gap_fits_section(const GapFinding& finding) {
  if (finding.fits.empty()) return {};
  std::string rows;
  for (const RunFit& fit : finding.fits)
    rows += row({text_cell(fit.run), text_cell(fit.held_out ? "held out" : "fitted"),
                 number_cell(fit.before_percent, 1), number_cell(fit.after_percent, 1),
                 number_cell(fit.whiteness, 3), number_cell(fit.input_correlation, 3),
                 number_cell(fit.bound, 3)});
  std::string html = table(
      "Fit: 100 (1 - |residual| / |motion about its mean|). Correlations of the residual after: the largest "
      "with "
      "itself and with the input, over 25 rows; of white noise 99 % of the lags stay below the bound. A "
      "residual "
      "beyond it still holds something that a model could predict.",
      {"Run", "Role", ">Fit before<br />%", ">Fit after<br />%", ">With itself", ">With the input", ">Bound"},
      rows);
  if (!finding.straw_men.empty()) {
    const int decimals = decimals_for(finding.noise_floor);
    std::string peers =
        row({text_cell("the model after"), text_cell(""), number_cell(finding.rmse_after, decimals)},
            "chosen") +
        row({text_cell("the model before"), text_cell(""), number_cell(finding.rmse_before, decimals)});
    for (const StrawMan& one : finding.straw_men)
      peers += row(
          {text_cell(one.name), number_cell(fmt::format("{}", one.order)), number_cell(one.rmse, decimals)});
    html += table("Models without physics, fitted to the same runs and simulated on the held-out ones.",
                  {"Model", ">Order", ">Held-out RMSE<br />mm"}, peers);
  }
  return section("Fit by run", html);
}

std::string gap_method_section(const GapFinding& finding) {
  const auto fitted = std::count_if(finding.candidates.begin(), finding.candidates.end(),
                                    [](const GapCandidate& c) { return c.fitted; });
  std::string html = facts({
      {"Data set", finding.dataset},
      {"Input", finding.force_drive ? "measured force" : "voltage of the needle stage"},
      {"Runs fitted to", name_list(finding.training_runs)},
      {"Runs held out, for selection", name_list(finding.held_out_runs)},
      {"Noise floor", fixed(finding.noise_floor, decimals_for(finding.noise_floor), "mm") +
                          (finding.noise_given ? ", given by the data set" : ", estimated from the data")},
      {"Candidates", fmt::format("{} scored, {} of them fitted", finding.candidates.size(), fitted)},
      {"Work", fixed(finding.seconds, 1, "s")},
  });
  if (!finding.warnings.empty()) html += "<h3>▲ Warnings</h3>\n" + list(finding.warnings);
  return section("Data and method", html);
}

}  // namespace biopsy::report
