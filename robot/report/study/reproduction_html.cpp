#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "robot/common/files/file.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/report/markup/html_markup.hpp"
#include "robot/report/plot/figure_svg.hpp"
#include "robot/report/study/paper_score.hpp"
#include "robot/report/study/reproduction_report.hpp"

namespace biopsy::report {
namespace {

using markup::number_cell, markup::section, markup::table, markup::text_cell;

constexpr const char* kReproductionStyle = R"css(
.verdict .bar-line { margin-top: 10px; font-size: 1rem; }
p { max-width: 62em; margin: 6px 0 10px; }
td.n, th.n { padding-left: 8px; }
td.verdict-cell { white-space: nowrap; }
td.note { color: #46525c; font-size: .85rem; max-width: 30em; }
tr.missed td { color: #b00020; } tr.missed td.quantity, tr.missed td.verdict-cell { font-weight: bold; }
tr.shown td { color: #5d6a75; background: #e9ecee; }
code { overflow-wrap: anywhere; font-size: .9rem; }
pre { background: #fff; border: 1px solid #aab1b7; padding: 6px 10px; margin: 6px 0 12px; white-space: pre-wrap; }
@media print {
  tr.missed td, tr.shown td { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  .figure-section p { break-after: avoid; }
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
  return markup::row(
      {"<td class=\"quantity\">" + escaped(row.quantity) + "</td>", number_cell(paper_text(row)),
       number_cell(ours_text(row)), number_cell(band_text(row)),
       "<td class=\"verdict-cell\">" + verdict_text(row) + "</td>", text_cell(leakage_text(row)),
       text_cell(held_out_text(row)), "<td class=\"note\">" + escaped(row.note) + "</td>"},
      row_class(row));
}

std::string rows_table(const PaperFigure& figure) {
  std::string rows;
  for (const PaperRow& row : figure.rows) rows += table_row(row);
  if (rows.empty()) return {};
  const std::string before = figure.number == "beyond" ? ">Paper's PI loop, our model" : ">Paper";
  return table("",
               {"Quantity", before, ">Ours", ">Band", "Verdict", "Leakage model", "Held out",
                "How it was read; why it is missed"},
               rows);
}

std::string panels(const PaperFigure& figure) {
  const FigureSize size = figure.panels.size() == 1 ? FigureSize{720, 280} : FigureSize{};
  std::vector<std::string> svgs;
  for (const FigurePanel& panel : figure.panels) svgs.push_back(figure_svg(panel, size));
  return markup::panels(svgs);
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
    rows += markup::row({text_cell(figure_name(figure)), text_cell(figure.title),
                         number_cell(share(score.numbers_ok, score.numbers)),
                         number_cell(share(score.trends_ok, score.trends))},
                        all ? "reached" : "missed");
  }
  return section("At a glance", table("", {"Figure", "Experiment", ">Numbers", ">Trends"}, rows));
}

// A part of the acceptance criterion, and what is missed in any case.
std::string criterion_line(bool passed, const std::string& what, std::size_t missed, std::size_t of) {
  std::string line = passed ? "✓ Passed: " + what : "<span class=\"alarm\">■ Not passed: " + what + "</span>";
  if (missed > 0)
    line += fmt::format(". <span class=\"alarm\">■ {} of {} missed; the reason stands in each row</span>",
                        missed, of);
  return "<p class=\"bar-line\">" + line + ".</p>\n";
}

std::string verdict_section(const Reproduction& r) {
  const PaperScore score = score_of(r);
  std::string remarks;
  for (const std::string& remark : score_remarks(r))
    remarks += "<p class=\"bar-line\">" + escaped(remark) + "</p>\n";
  const bool passes = score.enough_numbers() && score.every_trend();
  return markup::verdict_section(
      passes ? "" : "doubted", score_sentence(score) + ".",
      criterion_line(score.enough_numbers(), "90 % of the numbers within their band",
                     score.numbers - score.numbers_ok, score.numbers) +
          criterion_line(score.every_trend(), "every trend as stated", score.trends - score.trends_ok,
                         score.trends) +
          remarks +
          fmt::format("<p class=\"bar-line\">Model: {}. Everything is simulated; computed in {}.</p>\n",
                      escaped(r.model), fixed(r.seconds, 1, "s")) +
          (r.left_out.empty() ? std::string()
                              : fmt::format("<p class=\"bar-line alarm\">■ Interrupted: without {}.</p>\n",
                                            fmt::join(r.left_out, ", "))));
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
  std::vector<std::string> missed;
  for (const PaperRow& row : figure.rows)
    if (is_missed(row))
      missed.push_back(
          fmt::format("{}: paper {}, ours {}. {}", row.quantity, paper_text(row), ours_text(row), row.note));
  if (missed.empty()) return {};
  return "<h3>" + escaped(figure_name(figure)) + "</h3>\n" + markup::list(missed) + "<pre><code>" +
         escaped(gap_command(figure, model)) + "</code></pre>\n";
}

std::string findings_section(const Reproduction& r) {
  std::string html;
  for (const PaperFigure& figure : r.figures) html += finding(figure, r.model);
  if (html.empty()) return {};
  return section(
      "Findings, for the gap workflow",
      "<p>Numbers and trends that the model does not reach. Only a measurement can show which effect it "
      "lacks: "
      "record the experiment on your own stage as a data set (in place of measured/figure-…), and the "
      "command "
      "identifies the effect or the parameter that explains it. Record in open loop: a control loop, as in "
      "Fig. "
      "9, masks the behaviour of the stage; use <code>biopsy characterise staircase dc load</code> "
      "instead.</p>\n" +
          html);
}

}  // namespace

std::string reproduction_html(const Reproduction& r) {
  std::string html = verdict_section(r) + glance_section(r);
  for (const PaperFigure& figure : r.figures) html += figure_section(figure);
  return markup::page({.title = "The paper, reproduced",
                       .heading = "The paper's experiments, reproduced",
                       .style = kReproductionStyle},
                      html + findings_section(r));
}

void save_reproduction(const Reproduction& reproduction, const std::filesystem::path& folder) {
  atomic_write(folder / "report.html", reproduction_html(reproduction));
  atomic_write(folder / "reproduce.json",
               reproduction_json(reproduction));  // last: its presence means that the rest is there
}

}  // namespace biopsy::report
