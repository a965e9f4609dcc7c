#include <fmt/format.h>

#include <algorithm>

#include "robot/common/number_text.hpp"
#include "robot/common/sanitize_text.hpp"
#include "robot/report/plot/html_markup.hpp"
#include "robot/report/safety_case/case_page.hpp"
#include "robot/report/safety_case/gaps.hpp"

namespace biopsy::safety_case {
namespace {

namespace markup = report::markup;

constexpr const char* kStyle = R"css(
.verdict .sentence { font-size: 1.45rem; line-height: 1.35; font-weight: bold; }
.argument { background: #fff; border: 1px solid #aab1b7; }
.argument svg { width: 100%; height: auto; }
.columns { display: grid; grid-template-columns: 1fr 1fr; gap: 0 28px; }
ul { margin: 4px 0; padding-left: 20px; }
details summary { cursor: pointer; padding: 3px 0; }
)css";

std::string list_of(const std::vector<std::string>& items) {
  std::string out = "<ul>\n";
  for (const std::string& item : items) out += "<li>" + escaped(item) + "</li>\n";
  return out + "</ul>\n";
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

std::string limit_text(const Bar& bar) {
  if (bar.at_least && bar.at_most && *bar.at_least == *bar.at_most) return fmt::format("{:g}", *bar.at_least);
  std::string out;
  if (bar.at_least) out += fmt::format("≥ {:g} ", *bar.at_least);
  if (bar.at_most) out += fmt::format("≤ {:g} ", *bar.at_most);
  return out + bar.unit;
}

std::string bars_table(const SafetyCase& safety_case, const std::vector<Finding>& findings, bool quick) {
  std::string rows;
  for (const Source& source : safety_case.sources)
    for (const Bar& bar : source.bars) {
      const Finding* finding = finding_of(findings, source.id);
      const bool has = finding != nullptr && finding->figures.contains(bar.figure);
      const bool met = has && is_met(bar, *finding);
      const std::string verdict = met     ? "● met"
                                  : quick ? "○ not judged"
                                  : has   ? "▲ NOT MET"
                                          : "▲ NO EVIDENCE";
      rows +=
          "<tr>" + markup::text_cell(source.title) + markup::text_cell(bar.name) +
          markup::number_cell(has ? fmt::format("{:g} {}", finding->figures.at(bar.figure), bar.unit) : "–") +
          markup::number_cell(limit_text(bar)) +
          (met || quick ? markup::text_cell(verdict) : "<td class=\"alarm\">" + verdict + "</td>") +
          "</tr>\n";
    }
  return markup::table("", {"evidence", "figure", ">measured", ">bar", "verdict"}, rows);
}

std::string gaps_table(std::vector<Gap>::const_iterator from, std::vector<Gap>::const_iterator to) {
  std::string rows;
  for (auto gap = from; gap != to; ++gap)
    rows += "<tr>" + markup::text_cell(gap->where) + markup::text_cell(gap->what) + "</tr>\n";
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

std::string hazards_table(const SafetyCase& safety_case) {
  std::string rows;
  for (const Hazard& h : safety_case.hazards)
    rows += fmt::format("<tr id=\"{}\">", escaped(h.id)) + markup::text_cell(h.id) +
            markup::text_cell(h.name) + markup::text_cell(h.cause) + markup::text_cell(h.harm) +
            markup::number_cell(std::to_string(h.severity)) + markup::text_cell(h.detection) +
            markup::text_cell(h.reaction) + markup::number_cell(std::to_string(h.max_time_ms)) +
            markup::text_cell(joined(h.requirements)) + "</tr>\n";
  return markup::table(
      "Severity of the harm, unmitigated: 1 negligible to 5 catastrophic. Time: from the first sample that "
      "shows it "
      "to the reaction.",
      {"id", "hazard", "cause", "harm", ">severity", "found by", "reaction", ">time, ms", "requirements"},
      rows);
}

std::string requirement_row(const Requirement& requirement, const std::vector<Finding>& findings) {
  const std::vector<const TestResult*> tests = tests_for(findings, requirement.id);
  std::vector<std::string> names;
  names.reserve(tests.size());
  for (const TestResult* test : tests) names.push_back(test->name);
  const std::string shown = fmt::format("<td><details><summary>{} {}</summary>{}</details></td>",
                                        tests.size(), tests.size() == 1 ? "test" : "tests", list_of(names));
  return fmt::format("<tr id=\"{}\">", escaped(requirement.id)) + markup::text_cell(requirement.id) +
         markup::text_cell(requirement.text) + shown + markup::text_cell(joined(requirement.proofs)) +
         "</tr>\n";
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
    out += "<tr>";
    for (const std::string& column : columns)
      out += markup::text_cell(row.contains(column) ? row.at(column) : std::string());
    out += "</tr>\n";
  }
  std::vector<std::string> headings;
  headings.reserve(columns.size());
  for (const std::string& column : columns) headings.push_back(escaped(column));
  return "<details><summary>" + escaped(name) + fmt::format(", {}</summary>\n", report::counted(rows.size(), "row")) +
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
      markup::page_head("Safety case", kStyle) + "<body>\n<main>\n<h1>Safety case</h1>\n" +
      "<section class=\"verdict" + (gaps.empty() ? "" : " doubted") + "\">\n<p class=\"sentence\">" +
      escaped(case_sentence(safety_case, findings, gaps, build)) + "</p>\n" +
      markup::paragraph("Claim: " + safety_case.claim) +
      markup::paragraph(fmt::format("Build {} of {}, commit {}, code {}; evidence gathered in {:.0f} s.",
                                    build.version, build.date, short_commit(build.commit),
                                    build.code.substr(0, 12), build.seconds)) +
      "</section>\n" + gaps_section(gaps);
  html += markup::section("Evidence against its bars", bars_table(safety_case, findings, build.quick));
  html += "<div class=\"columns\">" + markup::section("Not covered", list_of(safety_case.not_covered)) +
          markup::section("Open", list_of(safety_case.open_items)) + "</div>\n";
  if (!argument_svg.empty())
    html += markup::section("Argument (GSN)",
                            "<div class=\"argument\">\n" + argument_svg +
                                "</div>\n<p>To read it at full size: argument.svg beside this page.</p>\n");
  html += markup::section("Hazards", hazards_table(safety_case));
  html += markup::section("Requirements", requirements_table(safety_case, findings));
  for (const Source& source : safety_case.sources)
    if (const Finding* finding = finding_of(findings, source.id)) html += evidence_section(source, *finding);
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace biopsy::safety_case
