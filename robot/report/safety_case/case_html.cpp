#include <fmt/format.h>

#include <algorithm>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/markup/html_markup.hpp"
#include "robot/report/safety_case/case_page.hpp"
#include "robot/report/safety_case/gaps.hpp"
#include "robot/report/safety_case/risk_checks.hpp"
#include "robot/report/safety_case/risk_document.hpp"

namespace biopsy::safety_case {
namespace {

namespace markup = report::markup;

constexpr const char* kCaseStyle = R"css(
.argument { background: #fff; border: 1px solid #aab1b7; }
.argument svg { width: 100%; height: auto; }
.columns { display: grid; grid-template-columns: 1fr 1fr; gap: 0 28px; }
ul { margin: 4px 0; padding-left: 20px; }
details summary { cursor: pointer; padding: 3px 0; }
)css";

std::string limit_text(const Criterion& criterion) {
  if (criterion.at_least && criterion.at_most && *criterion.at_least == *criterion.at_most)
    return fmt::format("{:g}", *criterion.at_least);
  std::string out;
  if (criterion.at_least) out += fmt::format("≥ {:g} ", *criterion.at_least);
  if (criterion.at_most) out += fmt::format("≤ {:g} ", *criterion.at_most);
  return out + criterion.unit;
}

std::string criteria_table(const SafetyCase& safety_case, const std::vector<Finding>& findings, bool quick) {
  std::string rows;
  for (const Source& source : safety_case.sources)
    for (const Criterion& criterion : source.criteria) {
      const Finding* finding = finding_of(findings, source.id);
      const bool has = finding != nullptr && finding->figures.contains(criterion.figure);
      const bool met = has && is_met(criterion, *finding);
      const std::string verdict = met     ? "● met"
                                  : quick ? "○ not judged"
                                  : has   ? "▲ NOT MET"
                                          : "▲ NO EVIDENCE";
      const std::string value =
          has ? fmt::format("{:g} {}", finding->figures.at(criterion.figure), criterion.unit) : "–";
      rows += markup::row(
          {markup::text_cell(source.title), markup::text_cell(criterion.name), markup::number_cell(value),
           markup::number_cell(limit_text(criterion)),
           met || quick ? markup::text_cell(verdict) : "<td class=\"alarm\">" + verdict + "</td>"});
    }
  return markup::table("", {"evidence", "figure", ">measured", ">acceptance criterion", "verdict"}, rows);
}

std::string gaps_table(std::vector<Gap>::const_iterator from, std::vector<Gap>::const_iterator to) {
  std::string rows;
  for (auto gap = from; gap != to; ++gap)
    rows += markup::row({markup::text_cell(gap->where), markup::text_cell(gap->what)});
  return markup::table("", {"where", "what"}, rows);
}

// As many as leave room for the rest of the first screen; the others behind a line.
std::string gaps_section(const std::vector<Gap>& gaps) {
  constexpr std::ptrdiff_t kShown = 8;
  if (gaps.empty()) return {};
  const auto split = gaps.begin() + std::min<std::ptrdiff_t>(kShown, std::ssize(gaps));
  std::string content = gaps_table(gaps.begin(), split);
  if (split != gaps.end())
    content += fmt::format("<details><summary>and {} more</summary>\n", gaps.end() - split) +
               gaps_table(split, gaps.end()) + "</details>\n";
  return markup::section("Gaps", content);
}

std::string short_commit(const std::string& commit) {
  return commit.substr(0, 12) + (commit.ends_with('+') ? "+ changes" : "");
}

// What the case says of itself, and every risk that is not acceptable.
std::vector<std::string> all_open(const SafetyCase& safety_case) {
  std::vector<std::string> items;
  for (const Risk* risk : open_risks(safety_case.risk))
    items.push_back(fmt::format("{} ({}), not acceptable: {}", risk->id, risk->hazard, risk->open));
  items.insert(items.end(), safety_case.open_items.begin(), safety_case.open_items.end());
  return items;
}

std::string id_cell(const std::string& id) {
  return fmt::format("<td id=\"{0}\">{0}</td>", escaped(id));
}

std::string hazards_table(const SafetyCase& safety_case) {
  std::string rows;
  for (const Hazard& h : safety_case.hazards)
    rows += markup::row({id_cell(h.id), markup::text_cell(h.name), markup::text_cell(h.cause),
                         markup::text_cell(h.harm), markup::number_cell(std::to_string(h.severity)),
                         markup::text_cell(h.detection), markup::text_cell(h.reaction),
                         markup::number_cell(h.max_time_ms == 0 ? "–" : std::to_string(h.max_time_ms)),
                         markup::text_cell(joined(h.requirements))});
  return markup::table(
      "Severity of the harm, unmitigated: 1 negligible to 5 catastrophic. Time: from the first sample that "
      "shows the hazard to the reaction.",
      {"id", "hazard", "cause", "harm", ">severity", "detected by", "reaction", ">time, ms", "requirements"},
      rows);
}

std::string requirement_row(const Requirement& requirement, const std::vector<Finding>& findings) {
  const std::vector<const TestResult*> tests = tests_for(findings, requirement.id);
  std::vector<std::string> names;
  names.reserve(tests.size());
  for (const TestResult* test : tests) names.push_back(test->name);
  const std::string shown = fmt::format("<td><details><summary>{}</summary>{}</details></td>",
                                        counted(tests.size(), "test"), markup::list(names));
  return markup::row({id_cell(requirement.id), markup::text_cell(requirement.text), shown,
                      markup::text_cell(joined(requirement.proofs))});
}

std::string requirements_table(const SafetyCase& safety_case, const std::vector<Finding>& findings) {
  std::string rows;
  for (const Requirement& requirement : safety_case.requirements)
    rows += requirement_row(requirement, findings);
  return markup::table("", {"id", "requirement", "passed tests that name it", "proofs"}, rows);
}

std::string rows_table(const std::string& name, const std::vector<Row>& rows) {
  std::vector<std::string> columns;
  for (const Row& row : rows)
    for (const auto& [column, text] : row)
      if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
  std::string out;
  for (const Row& row : rows) {
    std::vector<std::string> cells;
    for (const std::string& column : columns)
      cells.push_back(markup::text_cell(row.contains(column) ? row.at(column) : std::string()));
    out += markup::row(cells);
  }
  std::vector<std::string> headings;
  headings.reserve(columns.size());
  for (const std::string& column : columns) headings.push_back(escaped(column));
  return "<details><summary>" + escaped(name) + fmt::format(", {}</summary>\n", counted(rows.size(), "row")) +
         markup::table("", headings, out) + "</details>\n";
}

std::string evidence_section(const Source& source, const Finding& finding) {
  std::vector<std::pair<std::string, std::string>> figures;
  for (const auto& [name, value] : finding.figures) figures.emplace_back(name, fmt::format("{:g}", value));
  std::string content =
      markup::paragraph(fmt::format(
          "{}, commit {}, {:.1f} s, {}{}", finding.date, short_commit(finding.commit), finding.seconds,
          finding.passed ? "passed" : "FAILED", finding.quick ? ", short subset" : "")) +
      markup::facts(figures);
  for (const auto& [name, rows] : finding.tables) content += rows_table(name, rows);
  return markup::section(escaped(source.title), content);
}

}  // namespace

std::string case_html(const SafetyCase& safety_case, const std::vector<Finding>& findings,
                      const std::vector<Gap>& gaps, const Build& build, const std::string& argument_svg) {
  std::string html =
      markup::verdict_section(
          gaps.empty() ? "" : "doubted", case_sentence(safety_case, findings, gaps, build),
          markup::paragraph("Claim: " + safety_case.claim) +
              markup::paragraph(fmt::format(
                  "Build {} of {}, commit {}, code {}; evidence gathered in {:.0f} s.", build.version,
                  build.date, short_commit(build.commit), build.code.substr(0, 12), build.seconds))) +
      gaps_section(gaps) +
      markup::section("Results against acceptance criteria",
                      criteria_table(safety_case, findings, build.quick)) +
      "<div class=\"columns\">" + markup::section("Not covered", markup::list(safety_case.not_covered)) +
      markup::section("Open", markup::list(all_open(safety_case))) + "</div>\n";
  if (!argument_svg.empty())
    html += markup::section("Argument (GSN)",
                            "<div class=\"argument\">\n" + argument_svg +
                                "</div>\n<p>At full size: argument.svg beside this page.</p>\n");
  html += markup::section("Hazards", hazards_table(safety_case)) +
          markup::section("Requirements", requirements_table(safety_case, findings)) + risk_html(safety_case);
  for (const Source& source : safety_case.sources)
    if (const Finding* finding = finding_of(findings, source.id)) html += evidence_section(source, *finding);
  return markup::page({.title = "Safety case", .style = kCaseStyle}, html);
}

}  // namespace biopsy::safety_case
