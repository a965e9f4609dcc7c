#include "robot/report/study/reproduction_html.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "robot/common/number_text.hpp"
#include "robot/common/sanitize_text.hpp"
#include "robot/report/plot/figure_svg.hpp"
#include "robot/report/plot/html_markup.hpp"
#include "robot/report/procedure/html_sections.hpp"
#include "robot/report/study/paper_score.hpp"

namespace biopsy::report {
namespace {

using markup::number_cell, markup::section, markup::table, markup::text_cell;

constexpr const char* kStyle = R"css(
.verdict .sentence { font-size: 1.45rem; line-height: 1.35; font-weight: bold; }
.verdict .bar-line { margin-top: 10px; font-size: 1rem; }
.panels { display: grid; grid-template-columns: repeat(auto-fit, minmax(380px, 1fr)); gap: 10px 16px; align-items: end; }
.panels.lone { grid-template-columns: minmax(380px, 720px); }
.panels figure { margin: 0; }
p { max-width: 62em; margin: 6px 0 10px; }
td.n, th.n { padding-left: 8px; }
td.verdict-cell { white-space: nowrap; }
td.note { color: #46525c; font-size: .85rem; max-width: 30em; }
tr.missed td { color: #b00020; } tr.missed td.quantity, tr.missed td.verdict-cell { font-weight: bold; }
tr.shown td { color: #5d6a75; background: #e9ecee; }
code { overflow-wrap: anywhere; font-size: .9rem; }
pre { background: #fff; border: 1px solid #aab1b7; padding: 6px 10px; margin: 6px 0 12px; white-space: pre-wrap; }
@media print {
  .panels { grid-template-columns: 1fr 1fr; } .panels.lone { grid-template-columns: 125mm; }
  tr.missed td, tr.shown td { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  .figure-section p { break-after: avoid; } .panels { break-inside: avoid; }
}
)css";

std::string figure_name(const PaperFigure& figure) {
  const bool numbered =
      !figure.number.empty() && std::isdigit(static_cast<unsigned char>(figure.number[0])) != 0;
  return numbered ? "Fig. " + figure.number : figure.number == "beyond" ? "Beyond the paper" : figure.number;
}

std::string row_class(const PaperRow& row) {
  if (row.kind == RowKind::Shown) return "shown";
  return row.ok ? "reached" : "missed";
}

std::string table_row(const PaperRow& row) {
  return "<tr class=\"" + row_class(row) + "\"><td class=\"quantity\">" + escaped(row.quantity) + "</td>" +
         number_cell(paper_text(row)) + number_cell(ours_text(row)) + number_cell(band_text(row)) +
         "<td class=\"verdict-cell\">" + verdict_text(row) + "</td><td class=\"note\">" + escaped(row.note) +
         "</td></tr>\n";
}

std::string rows_table(const PaperFigure& figure) {
  std::string rows;
  for (const PaperRow& row : figure.rows) rows += table_row(row);
  if (rows.empty()) return {};
  const std::string before = figure.number == "beyond" ? ">Paper's PI loop, our model" : ">Paper";
  return table("", {"Quantity", before, ">Ours", ">Band", "Verdict", "How it was read; why it is missed"},
               rows);
}

std::string panels(const PaperFigure& figure) {
  if (figure.panels.empty()) return {};
  const bool lone = figure.panels.size() == 1;
  std::string html = fmt::format("<div class=\"panels{}\">\n", lone ? " lone" : "");
  const FigureSize size = lone ? FigureSize{720, 280} : FigureSize{};
  for (const FigurePanel& panel : figure.panels)
    html += "<figure>\n" + figure_svg(panel, size) + "\n</figure>\n";
  return html + "</div>\n";
}

std::string figure_section(const PaperFigure& figure) {
  return "<section class=\"figure-section\">\n<h2>" + escaped(figure_name(figure) + ": " + figure.title) +
         "</h2>\n" + markup::paragraph(figure.sentence) + panels(figure) + rows_table(figure) +
         "</section>\n";
}

std::string share(std::size_t ok, std::size_t all) {
  return all == 0 ? "–" : fmt::format("{} of {}", ok, all);
}

std::string glance_section(const Reproduction& r) {
  std::string rows;
  for (const PaperFigure& figure : r.figures) {
    const PaperScore score = score_of(figure);
    const bool all = score.numbers_ok == score.numbers && score.trends_ok == score.trends;
    rows += std::string("<tr class=\"") + (all ? "reached" : "missed") + "\">" +
            text_cell(figure_name(figure)) + text_cell(figure.title) +
            number_cell(share(score.numbers_ok, score.numbers)) +
            number_cell(share(score.trends_ok, score.trends)) + "</tr>\n";
  }
  return section("At a glance", table("", {"Figure", "Experiment", ">Numbers", ">Trends"}, rows));
}

// A part of the bar, and what is missed in any case: a part that is passed makes no miss less.
std::string bar_line(bool passed, const std::string& what, std::size_t missed, std::size_t of) {
  std::string line = passed ? "✓ Passed: " + what : "<span class=\"alarm\">■ Not passed: " + what + "</span>";
  if (missed > 0)
    line +=
        fmt::format(". <span class=\"alarm\">■ {} of {} missed; each says why in its row</span>", missed, of);
  return "<p class=\"bar-line\">" + line + ".</p>\n";
}

std::string verdict_section(const Reproduction& r) {
  const PaperScore score = score_of(r);
  const bool passes = score.enough_numbers() && score.every_trend();
  return std::string("<section class=\"verdict") + (passes ? "" : " doubted") +
         "\">\n<p class=\"sentence\">" + escaped(score_sentence(score)) + ".</p>\n" +
         bar_line(score.enough_numbers(), "nine numbers of ten within their band",
                  score.numbers - score.numbers_ok, score.numbers) +
         bar_line(score.every_trend(), "every trend as stated", score.trends - score.trends_ok,
                  score.trends) +
         "<p class=\"bar-line\">Model: " + escaped(r.model) + ". Everything is simulated; it took " +
         escaped(fixed(r.seconds, 1, "s")) + ".</p>\n" +
         (r.left_out.empty() ? std::string()
                             : fmt::format("<p class=\"bar-line alarm\">■ Interrupted: without {}.</p>\n",
                                           fmt::join(r.left_out, ", "))) +
         "</section>\n";
}

// A word of a command line as a shell takes it.
std::string shell_word(const std::string& word) {
  const bool harmless = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '/' || c == '.' || c == '-' || c == '_';
  });
  if (harmless) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string gap_command(const PaperFigure& figure, const std::string& model) {
  return fmt::format("biopsy gap {} --model {} --out {}", shell_word("measured/figure-" + figure.number),
                     shell_word(model), shell_word("out/gap-figure-" + figure.number));
}

std::string finding(const PaperFigure& figure, const std::string& model) {
  std::string items;
  for (const PaperRow& row : figure.rows)
    if (is_missed(row))
      items += "<li>" +
               escaped(fmt::format("{}: paper {}, ours {}. {}", row.quantity, paper_text(row), ours_text(row),
                                   row.note)) +
               "</li>\n";
  if (items.empty()) return {};
  return "<h3>" + escaped(figure_name(figure)) + "</h3>\n<ul>\n" + items + "</ul>\n<pre><code>" +
         escaped(gap_command(figure, model)) + "</code></pre>\n";
}

// Which effect is missing is a question to a measurement, not to this page.
std::string findings_section(const Reproduction& r) {
  std::string html;
  for (const PaperFigure& figure : r.figures) html += finding(figure, r.model);
  if (html.empty()) return {};
  return section(
      "Findings, for the gap workflow",
      "<p>What the model does not reach. Which effect it lacks only a measurement can say: record the "
      "experiment "
      "on your own stage as a data set (measured/figure-… stands for yours), and this command names the "
      "effect or "
      "the parameter that explains it. Open loop: under a control loop, as in Fig. 9, the stage does not "
      "show what it "
      "does by itself, and <code>biopsy characterise staircase dc load</code> is what answers for it.</p>\n" +
          html);
}

}  // namespace

std::string reproduction_html(const Reproduction& r) {
  std::string html = markup::page_head("The paper, reproduced", kStyle) +
                     "<body>\n<main>\n<h1>The paper's experiments, reproduced</h1>\n" + verdict_section(r) +
                     glance_section(r);
  for (const PaperFigure& figure : r.figures) html += figure_section(figure);
  return html + findings_section(r) + "</main>\n</body>\n</html>\n";
}

}  // namespace biopsy::report
