#include "robot/report/study/study_html.hpp"

#include "robot/common/text/sanitize_text.hpp"
#include "robot/report/markup/html_markup.hpp"
#include "robot/report/plot/figure_svg.hpp"

namespace biopsy::report {
namespace {

constexpr const char* kStudyStyle = R"css(
td.n, th.n { padding-left: 8px; }
@media print { section h2 { break-after: avoid; } }
)css";

std::string table_section(const StudyTable& table) {
  std::string rows;
  for (const std::vector<std::string>& row : table.rows) {
    std::vector<std::string> cells;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool number = i < table.columns.size() && table.columns[i].starts_with('>');
      cells.push_back(number ? markup::number_cell(row[i]) : markup::text_cell(row[i]));
    }
    rows += markup::row(cells);
  }
  std::vector<std::string> columns;
  for (const std::string& column : table.columns)
    columns.push_back(column.starts_with('>') ? ">" + escaped(column.substr(1)) : escaped(column));
  return markup::section(escaped(table.heading), markup::table("", columns, rows));
}

std::string pictures(const std::vector<FigurePanel>& panels) {
  std::string html;
  for (const FigurePanel& panel : panels) html += markup::figure(figure_svg(panel), escaped(panel.title));
  return html.empty() ? html : markup::section("Pictures", "<div class=\"panels\">\n" + html + "</div>\n");
}

}  // namespace

std::string study_html(const StudyPage& page) {
  std::string remarks, tables;
  for (const std::string& remark : page.remarks) remarks += markup::paragraph(remark);
  for (const StudyTable& table : page.tables) tables += table_section(table);
  return markup::page({.title = page.title, .style = kStudyStyle},
                      markup::verdict_section(page.doubted ? "doubted" : "", page.sentence, remarks) +
                          tables + pictures(page.panels));
}

}  // namespace biopsy::report
