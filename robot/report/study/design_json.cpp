#include "robot/common/files/whole_file.hpp"
#include "robot/report/markup/json_values.hpp"
#include "robot/report/study/design_html.hpp"

namespace biopsy::report {
namespace {

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

std::string design_json(const DesignStudy& study) {
  return json_file({{"model", study.model},
                    {"paper", stack_json(study.paper)},
                    {"best", json_list(study.best, stack_json)},
                    {"demands", study.demands},
                    {"assumed", study.assumed},
                    {"evaluated", study.evaluated},
                    {"seconds", study.seconds}});
}

void save_design(const DesignStudy& study, const std::filesystem::path& folder) {
  atomic_write(folder / "report.html", design_html(study));
  atomic_write(folder / "design.json",
               design_json(study));  // last: its presence means that the rest is there
}

}  // namespace biopsy::report
