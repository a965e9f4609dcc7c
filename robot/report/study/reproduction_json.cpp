#include "robot/report/markup/json_values.hpp"
#include "robot/report/study/paper_score.hpp"
#include "robot/report/study/reproduction_report.hpp"

namespace biopsy::report {
namespace {

Json row_json(const PaperRow& row) {
  return {{"figure", row.figure},
          {"quantity", row.quantity},
          {"unit", row.unit},
          {"kind", kind_name(row.kind)},
          {"paper", json_number(row.paper)},
          {"ours", json_number(row.ours)},
          {"band", json_number(row.band)},
          {"ok", row.ok},
          {"note", row.note}};
}

Json finding_json(const PaperRow* row) {
  return {{"figure", row->figure},
          {"quantity", row->quantity},
          {"unit", row->unit},
          {"paper", json_number(row->paper)},
          {"ours", json_number(row->ours)},
          {"note", row->note}};
}

}  // namespace

std::string reproduction_json(const Reproduction& r) {
  Json rows = Json::array();
  for (const PaperFigure& figure : r.figures)
    for (const PaperRow& row : figure.rows) rows.push_back(row_json(row));
  Json all = {{"rows", rows},
              {"findings", json_list(missed_rows(r), finding_json)},
              {"model", r.model},
              {"seconds", json_number(r.seconds)}};
  if (!r.left_out.empty()) all["interrupted"] = true, all["left_out"] = r.left_out;
  return json_file(all);
}

}  // namespace biopsy::report
