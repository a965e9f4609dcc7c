// The risk management file printed: as Markdown and as HTML.
#include <fmt/format.h>

#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/markup/html_markup.hpp"
#include "robot/report/safety_case/risk_document.hpp"

namespace biopsy::safety_case {
namespace {

constexpr const char* kRiskPageHead = R"(# Risk management file

In the style of ISO 14971, with software items and SOUP after IEC 62304, a threat model after IEC 81001-5-1 and use scenarios after
IEC 62366. Conformity with none of them is claimed.

This page is generated from [risk.toml](../../safety/case/risk.toml), [software.toml](../../safety/case/software.toml),
[threats.toml](../../safety/case/threats.toml) and [scenarios.toml](../../safety/case/scenarios.toml); a test compares it with the
program. Renew it, do not edit it: `./dev docs`. Hazards (H-nn) are in [hazards.toml](../../safety/case/hazards.toml), requirements (R-nn) in
[requirements.toml](../../safety/case/requirements.toml), the programs that measure in
[evidence.toml](../../safety/case/evidence.toml). The figures that they measured of a build are in the report of the
[safety case](safety-case.md), not here.

)";

// One cell of a table of Markdown.
std::string markdown_cell(const std::string& text) {
  std::string out;
  for (const char letter : text) {
    if (letter == '|' || letter == '\\' || letter == '*' || letter == '<') out += '\\';
    out += letter == '\n' ? ' ' : letter;
  }
  return out;
}

std::string markdown_row(const std::vector<std::string>& cells) {
  std::string out = "|";
  for (const std::string& cell : cells) out += cell.empty() ? " |" : " " + markdown_cell(cell) + " |";
  return out + "\n";
}

std::string markdown_of(const DocumentSection& section) {
  std::string out =
      fmt::format("{} {}\n\n", std::string(static_cast<std::size_t>(section.level), '#'), section.heading);
  for (const std::string& sentence : section.sentences) out += "- " + sentence + "\n";
  if (!section.sentences.empty()) out += "\n";
  for (const auto& [name, text] : section.facts) out += fmt::format("- *{}*: {}\n", name, text);
  if (!section.facts.empty()) out += "\n";
  if (section.table.rows.empty()) return out;
  out += markdown_row(section.table.headings) + "|";
  for (std::size_t i = 0; i < section.table.headings.size(); ++i) out += "---|";
  out += "\n";
  for (const std::vector<std::string>& row : section.table.rows) out += markdown_row(row);
  return out + "\n";
}

std::string html_of(const DocumentSection& section) {
  std::string content = section.sentences.empty() ? "" : report::markup::list(section.sentences);
  if (!section.facts.empty()) content += report::markup::facts(section.facts);
  std::string rows;
  for (const std::vector<std::string>& row : section.table.rows) {
    std::vector<std::string> cells;
    cells.reserve(row.size());
    for (const std::string& cell : row) cells.push_back(report::markup::text_cell(cell));
    rows += report::markup::row(cells);
  }
  std::vector<std::string> headings;
  for (const std::string& heading : section.table.headings) headings.push_back(escaped(heading));
  if (!rows.empty()) content += report::markup::table("", headings, rows);
  if (section.level == 2) return report::markup::section(escaped(section.heading), content);
  return "<details><summary>" + escaped(section.heading) + "</summary>\n" + content + "</details>\n";
}

}  // namespace

std::string risk_markdown(const SafetyCase& safety_case) {
  std::string page = kRiskPageHead;
  for (const std::string& line : wrapped(safety_case.risk.scope, 110)) page += line + "\n";
  page += "\n";
  for (const DocumentSection& section : risk_document(safety_case)) page += markdown_of(section);
  while (page.ends_with("\n\n")) page.pop_back();
  return page;
}

std::string risk_html(const SafetyCase& safety_case) {
  std::string html =
      report::markup::section("Risk management file", report::markup::paragraph(safety_case.risk.scope));
  for (const DocumentSection& section : risk_document(safety_case))
    html += section.level == 2 && section.sentences.empty() && section.table.rows.empty()
                ? "<h2>" + escaped(section.heading) + "</h2>\n"
                : html_of(section);
  return html;
}

}  // namespace biopsy::safety_case
