#include "robot/report/study/reproduction_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "robot/report/study/paper_score.hpp"

namespace biopsy::report {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json row_json(const PaperRow& row) {
  return {{"figure", row.figure},
          {"quantity", row.quantity},
          {"unit", row.unit},
          {"kind", kind_name(row.kind)},
          {"paper", number(row.paper)},
          {"ours", number(row.ours)},
          {"band", number(row.band)},
          {"ok", row.ok},
          {"note", row.note}};
}

Json finding_json(const PaperRow& row) {
  return {{"figure", row.figure},       {"quantity", row.quantity}, {"unit", row.unit},
          {"paper", number(row.paper)}, {"ours", number(row.ours)}, {"note", row.note}};
}

}  // namespace

std::string reproduction_json(const Reproduction& r) {
  Json rows = Json::array(), findings = Json::array();
  for (const PaperFigure& figure : r.figures)
    for (const PaperRow& row : figure.rows) rows.push_back(row_json(row));
  for (const PaperRow* row : missed_rows(r)) findings.push_back(finding_json(*row));
  Json all = {
      {"rows", rows}, {"findings", findings}, {"model", r.model}, {"seconds", number(r.seconds)}};
  if (!r.left_out.empty()) all["interrupted"] = true, all["left_out"] = r.left_out;
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace biopsy::report
