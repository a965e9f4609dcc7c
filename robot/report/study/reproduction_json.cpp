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
          {"leakage_ok", row.leakage_ok ? Json(*row.leakage_ok) : Json(nullptr)},
          {"held_out", row.held_out ? json_number(row.held_out->ours) : Json(nullptr)},
          {"held_out_ok", row.held_out ? Json(row.held_out->ok) : Json(nullptr)},
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

Json share_json(const Share& share) {
  return {{"of", share.of}, {"ok", share.ok}};
}

Json score_json(const Reproduction& r) {
  const PaperScore s = score_of(r);
  return {{"numbers", share_json({s.numbers, s.numbers_ok})},
          {"statements", share_json({s.trends, s.trends_ok})},
          {"closed_forms", share_json({s.theory, s.theory_ok})},
          {"leakage_numbers", share_json(s.leakage_numbers)},
          {"leakage_statements", share_json(s.leakage_trends)},
          {"beyond_leakage", share_json(s.beyond_leakage)},
          {"held_out_numbers", share_json(s.held_out_numbers)},
          {"held_out_statements", share_json(s.held_out_trends)}};
}

Json fitted_json(const FittedTo& fitted) {
  return {{"unknowns", fitted.unknowns},
          {"numbers", fitted.numbers},
          {"statements", fitted.statements},
          {"command", fitted.command}};
}

}  // namespace

std::string reproduction_json(const Reproduction& r) {
  Json rows = Json::array();
  for (const PaperFigure& figure : r.figures)
    for (const PaperRow& row : figure.rows) rows.push_back(row_json(row));
  Json all = {{"rows", rows},           {"findings", json_list(missed_rows(r), finding_json)},
              {"score", score_json(r)}, {"fitted", r.fitted ? fitted_json(*r.fitted) : Json(nullptr)},
              {"model", r.model},       {"seconds", json_number(r.seconds)}};
  if (!r.left_out.empty()) all["interrupted"] = true, all["left_out"] = r.left_out;
  return json_file(all);
}

}  // namespace biopsy::report
