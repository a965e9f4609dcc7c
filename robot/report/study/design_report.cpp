#include "robot/report/study/design_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "robot/common/files/file.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/report/markup/html_markup.hpp"
#include "robot/report/markup/json_values.hpp"
#include "robot/report/plot/figure_svg.hpp"

namespace biopsy::report {
namespace {

constexpr const char* kDesignStyle = R"css(
td.n, th.n { padding: 3px 0 3px 6px; font-size: .82rem; } th.n { white-space: normal; }
tr.paper td { background: #f3ead9; font-weight: bold; }
p, li { max-width: 62em; }
@media print { tr.paper td { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
)css";

struct Column {
  const char* heading;
  int decimals;
  double (*value)(const DesignedStack&);
};

constexpr std::array<Column, 13> kDesignColumns{
    {{"oil, mL", 2, [](const DesignedStack& s) { return s.design.oil_mL; }},
     {"side, mm", 1, [](const DesignedStack& s) { return s.design.side_mm; }},
     {"film, µm", 0, [](const DesignedStack& s) { return s.design.film_um; }},
     {"pouches", 0, [](const DesignedStack& s) { return s.design.pouches; }},
     {"spring, N/mm", 3, [](const DesignedStack& s) { return s.design.spring_N_per_mm; }},
     {"drive, kV", 2, [](const DesignedStack& s) { return s.design.drive_kV; }},
     {"stroke, mm", 2, [](const DesignedStack& s) { return s.figures.stroke_mm; }},
     {"ripple, mm", 3, [](const DesignedStack& s) { return s.figures.ripple_mm; }},
     {"bandwidth, Hz", 1, [](const DesignedStack& s) { return s.figures.bandwidth_Hz; }},
     {"field, V/µm", 0, [](const DesignedStack& s) { return s.figures.field_V_per_um; }},
     {"margin", 2, [](const DesignedStack& s) { return s.figures.breakdown_margin; }},
     {"height, mm", 1, [](const DesignedStack& s) { return s.figures.height_mm; }},
     {"strain, %", 0,
      [](const DesignedStack& s) { return 100.0 * s.figures.stroke_mm / s.figures.height_mm; }}}};

std::string table_row(const std::string& name, const DesignedStack& stack, const char* css_class = "") {
  std::vector<std::string> cells{markup::text_cell(name)};
  for (const Column& column : kDesignColumns)
    cells.push_back(markup::number_cell(column.value(stack), column.decimals));
  return markup::row(cells, css_class);
}

std::string designs_table(const DesignStudy& study) {
  std::vector<std::string> headings{"design"};
  for (const Column& column : kDesignColumns) headings.push_back(std::string(">") + column.heading);
  std::string rows = table_row("the paper's", study.paper, "paper");
  for (std::size_t i = 0; i < study.best.size(); ++i) rows += table_row(std::to_string(i + 1), study.best[i]);
  return markup::table(
      "Margin: the film's guaranteed strength over the field of the whole voltage; numbers as in the "
      "pictures",
      headings, rows);
}

std::string paper_result(const DesignStudy& study) {
  if (study.paper.broken.empty())
    return markup::paragraph("✓ The paper's own design meets every requirement.");
  return markup::alarm("The paper's own design does not meet every requirement:") +
         markup::list(study.paper.broken);
}

bool no_worse(const StackFigures& a, const StackFigures& b) {
  return a.stroke_mm >= b.stroke_mm && a.ripple_mm <= b.ripple_mm && a.bandwidth_Hz >= b.bandwidth_Hz &&
         a.breakdown_margin >= b.breakdown_margin && a.height_mm <= b.height_mm;
}

std::string sentence(const DesignStudy& study) {
  if (study.best.empty()) return fmt::format("None of {} designs meets every requirement.", study.evaluated);
  const auto better = std::count_if(study.best.begin(), study.best.end(), [&](const DesignedStack& stack) {
    return no_worse(stack.figures, study.paper.figures);
  });
  return fmt::format(
      "{} Pareto-optimal designs of {} evaluated; {} of them at least as good as the paper's in "
      "every figure.",
      study.best.size(), study.evaluated, better == 0 ? "none" : std::to_string(better));
}

Json stack_json(const DesignedStack& stack) {
  const StackDesign& d = stack.design;
  const StackFigures& f = stack.figures;
  return {{"oil_mL", json_number(d.oil_mL)},
          {"side_mm", json_number(d.side_mm)},
          {"film_um", json_number(d.film_um)},
          {"pouches", json_number(d.pouches)},
          {"spring_N_per_mm", json_number(d.spring_N_per_mm)},
          {"drive_kV", json_number(d.drive_kV)},
          {"stroke_mm", json_number(f.stroke_mm)},
          {"ripple_mm", json_number(f.ripple_mm)},
          {"bandwidth_Hz", json_number(f.bandwidth_Hz)},
          {"field_V_per_um", json_number(f.field_V_per_um)},
          {"breakdown_margin", json_number(f.breakdown_margin)},
          {"height_mm", json_number(f.height_mm)},
          {"broken", stack.broken}};
}

}  // namespace

std::string design_html(const DesignStudy& study) {
  std::vector<std::string> panels;
  for (const FigurePanel& panel : study.panels) panels.push_back(figure_svg(panel));
  return markup::page(
      {.title = "Design study", .heading = "Design study of the stack", .style = kDesignStyle},
      markup::verdict_section("", sentence(study),
                              paper_result(study) + markup::paragraph("Scaled from " + study.model +
                                                                      "; everything is simulated.")) +
          markup::section("Trade-offs", markup::panels(panels)) +
          markup::section("Designs", designs_table(study)) +
          markup::section("Requirements and their reasons", markup::list(study.demands)) +
          markup::section("Assumptions", markup::list(study.assumed)));
}

std::string design_console(const DesignStudy& study) {
  std::string text = fmt::format("{:<12}", "design");
  for (const Column& column : kDesignColumns) text += fmt::format(" {:>13}", column.heading);
  const auto line = [](const std::string& name, const DesignedStack& stack) {
    std::string out = fmt::format("\n{:<12}", name);
    for (const Column& column : kDesignColumns)
      out += fmt::format(" {:>13}", fixed(column.value(stack), column.decimals));
    return out;
  };
  text += line("the paper's", study.paper);
  for (std::size_t i = 0; i < study.best.size(); ++i) text += line(fmt::format("{}", i + 1), study.best[i]);
  text += "\n\n" + sentence(study) + "\n";
  for (const std::string& broken : study.paper.broken) text += "the paper's own: " + broken + "\n";
  return text;
}

std::string design_json(const DesignStudy& study) {
  Json all = {{"model", study.model},
              {"paper", stack_json(study.paper)},
              {"best", json_list(study.best, stack_json)},
              {"demands", study.demands},
              {"assumed", study.assumed},
              {"evaluated", study.evaluated},
              {"seconds", study.seconds}};
  if (study.interrupted) all["interrupted"] = true;
  return json_file(all);
}

void save_design(const DesignStudy& study, const std::filesystem::path& folder) {
  atomic_write(folder / "report.html", design_html(study));
  atomic_write(folder / "design.json",
               design_json(study));  // last: its presence means that the rest is there
}

}  // namespace biopsy::report
