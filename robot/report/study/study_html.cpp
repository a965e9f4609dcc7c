#include "robot/report/study/study_html.hpp"

#include "robot/common/sanitize_text.hpp"
#include "robot/report/plot/figure_svg.hpp"
#include "robot/report/plot/html_markup.hpp"
#include "robot/report/procedure/html_sections.hpp"

namespace biopsy::report {
namespace {

constexpr const char* kStyle = R"css(
.verdict .sentence { font-size: 1.45rem; line-height: 1.35; font-weight: bold; }
.panels { display: grid; grid-template-columns: repeat(auto-fit, minmax(380px, 1fr)); gap: 10px 16px; align-items: end; }
.panels figure { margin: 0; }
td.n, th.n { padding-left: 8px; }
@media print { .panels { grid-template-columns: 1fr 1fr; } section h2 { break-after: avoid; } }
)css";

std::string table_section(const StudyTable& table) {
  std::string rows;
  for (const std::vector<std::string>& row : table.rows) {
    rows += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool number = i < table.columns.size() && table.columns[i].starts_with('>');
      rows += number ? markup::number_cell(row[i]) : markup::text_cell(row[i]);
    }
    rows += "</tr>\n";
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
  std::string html = markup::page_head(page.title, kStyle) + "<body>\n<main>\n<h1>" + escaped(page.title) +
                     "</h1>\n<section class=\"verdict" + (page.doubted ? " doubted" : "") +
                     "\">\n<p class=\"sentence\">" + escaped(page.sentence) + "</p>\n";
  for (const std::string& remark : page.remarks) html += markup::paragraph(remark);
  html += "</section>\n";
  for (const StudyTable& table : page.tables) html += table_section(table);
  return html + pictures(page.panels) + "</main>\n</body>\n</html>\n";
}

}  // namespace biopsy::report
