#include <fmt/format.h>

#include <cmath>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/gap/gap_labels.hpp"
#include "robot/report/gap/gap_sections.hpp"
#include "robot/report/markup/html_markup.hpp"

namespace biopsy::report {
namespace {

using namespace markup;

std::string coefficient_row(const TermCoefficient& c) {
  return row({name_cell(c.product.empty() ? "constant" : c.product, c.name),
              number_cell(estimate_text(c.value, c.std)), number_cell(interval_text(c.value, c.std)),
              text_cell(c.unit), number_cell(percent_text(c.share))});
}

std::string range_text(const TermVariableRange& range) {
  return fmt::format("{} from {:.4g} to {:.4g} {}", range.variable, range.low, range.high, range.unit);
}

}  // namespace

std::string equation_text(const ProposedTerm& term) {
  std::string out = "F =";
  for (const TermCoefficient& c : term.coefficients) {
    const bool first = &c == &term.coefficients.front();
    const char* sign = c.value < 0.0 ? "-" : first ? "" : "+";
    out += fmt::format(" {}{}{:.4g}{}{}", sign, first ? "" : " ", std::abs(c.value),
                       c.product.empty() ? "" : " ", c.product);
  }
  if (term.exponent > 0.0) out += fmt::format(", n = {:.3g}", term.exponent);
  if (term.period_mm > 0.0) out += fmt::format(", k = 2π/{:.4g} mm", term.period_mm);
  if (term.memory_s > 0.0) out += fmt::format(", q forgotten within {:.3g} s", term.memory_s);
  return out;
}

std::string gap_proposed_section(const GapFinding& finding) {
  if (!finding.proposed) return {};
  const ProposedTerm& term = *finding.proposed;
  std::string rows;
  for (const TermCoefficient& c : term.coefficients) rows += coefficient_row(c);
  std::vector<std::string> seen;
  for (const TermVariableRange& range : term.seen) seen.push_back(range_text(range));
  std::string html =
      paragraph(
          "A force on plate A, N up, that no effect of the library gives. It is an equation that fits, "
          "not the name of a cause.") +
      fmt::format("<p><strong>{}</strong></p>\n", escaped(equation_text(term))) +
      table(
          "Value ± one standard deviation; the interval is the value ± 1.96 of them. Share: of the forces "
          "over the recording.",
          {"Product", ">Value", ">95 % interval", "Unit", ">Share"}, rows);
  if (term.memory_s > 0.0)
    html += paragraph(fmt::format("q follows x with a time constant of {} s.",
                                  estimate_text(term.memory_s, term.memory_std)));
  if (term.exponent > 0.0)
    html += paragraph(fmt::format("n is {}.", estimate_text(term.exponent, term.exponent_std)));
  if (term.period_mm > 0.0)
    html += paragraph(
        fmt::format("k is 2π over a period of {} mm.", estimate_text(term.period_mm, term.period_std)));
  html += paragraph(fmt::format(
      "Seen with {}; outside, the force is taken as at the edge. On held-out runs {:.3g} mm were left by the "
      "given model and {:.3g} mm by its best calibration; with the term {:.3g} mm are. It may be {}.",
      joined(seen, ", ", " and "), term.rmse_before, term.rmse_calibrated, term.rmse_after, term.meaning));
  if (!term.rivals.empty())
    html += paragraph("Nearly as little is left by: " + joined(term.rivals, "; ") + ".");
  return section("Proposed term", html);
}

}  // namespace biopsy::report
