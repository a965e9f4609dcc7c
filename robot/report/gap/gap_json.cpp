#include "robot/report/gap/gap_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "robot/report/gap/gap_labels.hpp"

namespace biopsy::report {
namespace {

using Json = nlohmann::ordered_json;

// Not rounded: a parameter may be 2e-9, its standard deviation a thousandth of that.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

template <class Values, class Written>
Json list_of(const Values& values, Written written) {
  Json list = Json::array();
  for (const auto& value : values) list.push_back(written(value));
  return list;
}

Json effect_json(const FoundEffect& effect) {
  Json parameters = Json::object();
  for (const GapEstimate& p : effect.parameters)
    parameters[p.name] = {{"value", number(p.value)}, {"std", number(p.std)}};
  return {{"name", effect.name},
          {"probability", number(effect.probability)},
          {"parameters", parameters},
          {"confused_with", list_of(effect.confused_with, [](const GapProbability& other) {
             return Json{{"name", other.name}, {"probability", number(other.probability)}};
           })}};
}

Json changed_json(const ChangedParameter& p) {
  return {{"name", p.name}, {"before", number(p.before)}, {"after", number(p.after)}, {"std", number(p.std)}};
}

Json regime_json(const GapRegime& regime) {
  return {{"regime", regime.name},
          {"share_of_time", number(regime.share_of_time)},
          {"share_of_excess_error", number(regime.share_of_excess_error)}};
}

Json experiment_json(const NextExperiment& next) {
  if (next.name.empty()) return nullptr;
  return {{"name", next.name}, {"separates", next.separates}};
}

Json candidate_json(const GapCandidate& c) {
  return {{"name", c.name},
          {"kind", c.kind == CandidateKind::Effect ? "effect" : "parameter"},
          {"round", c.round},
          {"score", number(c.score)},
          {"fitted", c.fitted},
          {"held_out_rmse_mm", number(c.held_out_rmse)},
          {"probability", number(c.probability)},
          {"chosen", c.chosen}};
}

Json shape_json(const ResidualShape& shape) {
  return {{"quantity", shape.quantity},
          {"unit", shape.unit},
          {"share_explained", number(shape.share_explained)},
          {"at", numbers(shape.at)},
          {"mean_mm", numbers(shape.mean)},
          {"count", numbers(shape.count)}};
}

Json margin_json(const MarginChange& m) {
  return {{"plan", m.plan},
          {"quantity", m.quantity},
          {"unit", m.unit},
          {"limit", number(m.limit)},
          {"before", number(m.before)},
          {"after", number(m.after)},
          {"ok", m.ok}};
}

}  // namespace

std::string gap_json(const GapFinding& f) {
  Json report = {
      {"verdict", word(f.verdict)},
      {"effects", list_of(f.effects, effect_json)},
      {"parameters_changed", list_of(f.parameters_changed, changed_json)},
      {"rmse_mm",
       {{"before", number(f.rmse_before)},
        {"after", number(f.rmse_after)},
        {"noise_floor", number(f.noise_floor)}}},
      {"gap_closed", number(f.gap_closed)},
      {"where", list_of(f.where, regime_json)},
      {"next_experiment", experiment_json(f.next)},
      {"held_out_runs", f.held_out_runs},
      {"seconds", number(f.seconds)},
      {"sentence", f.sentence},
      {"training_runs", f.training_runs},
      {"candidates", list_of(f.candidates, candidate_json)},
      {"shapes", list_of(f.shapes, shape_json)},
      {"margins", list_of(f.margins, margin_json)},
      {"warnings", f.warnings},
  };
  if (f.interrupted) report["interrupted"] = true;
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace biopsy::report
