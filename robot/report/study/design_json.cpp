#include <cmath>
#include <nlohmann/json.hpp>

#include "robot/common/files/file.hpp"
#include "robot/report/study/design_html.hpp"

namespace biopsy::report {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json stack_json(const DesignedStack& stack) {
  const StackDesign& d = stack.design;
  const StackFigures& f = stack.figures;
  return {{"oil_mL", number(d.oil_mL)},
          {"side_mm", number(d.side_mm)},
          {"film_um", number(d.film_um)},
          {"pouches", number(d.pouches)},
          {"spring_N_per_mm", number(d.spring_N_per_mm)},
          {"drive_kV", number(d.drive_kV)},
          {"stroke_mm", number(f.stroke_mm)},
          {"ripple_mm", number(f.ripple_mm)},
          {"bandwidth_Hz", number(f.bandwidth_Hz)},
          {"field_V_per_um", number(f.field_V_per_um)},
          {"breakdown_margin", number(f.breakdown_margin)},
          {"height_mm", number(f.height_mm)},
          {"broken", stack.broken}};
}

}  // namespace

std::string design_json(const DesignStudy& study) {
  Json best = Json::array();
  for (const DesignedStack& stack : study.best) best.push_back(stack_json(stack));
  Json all = {
      {"model", study.model},     {"paper", stack_json(study.paper)}, {"best", best},
      {"demands", study.demands}, {"assumed", study.assumed},         {"evaluated", study.evaluated},
      {"seconds", study.seconds}};
  if (study.interrupted) all["interrupted"] = true;
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void save_design(const DesignStudy& study, const std::filesystem::path& folder) {
  atomic_write(folder / "report.html", design_html(study));
  atomic_write(folder / "design.json", design_json(study));  // last: who finds it finds the rest too
}

}  // namespace biopsy::report
