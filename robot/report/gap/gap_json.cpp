#include "robot/report/gap/gap_labels.hpp"
#include "robot/report/gap/gap_report.hpp"
#include "robot/report/markup/json_values.hpp"

namespace biopsy::report {
namespace {

Json numbers(const std::vector<double>& values) {
  return json_list(values, json_number);
}

Json effect_json(const FoundEffect& effect) {
  Json parameters = Json::object();
  for (const GapEstimate& p : effect.parameters)
    parameters[p.name] = {{"value", json_number(p.value)}, {"std", json_number(p.std)}};
  return {{"name", effect.name},
          {"probability", json_number(effect.probability)},
          {"parameters", parameters},
          {"confused_with", json_list(effect.confused_with, [](const GapProbability& other) {
             return Json{{"name", other.name}, {"probability", json_number(other.probability)}};
           })}};
}

Json changed_json(const ChangedParameter& p) {
  return {{"name", p.name},
          {"before", json_number(p.before)},
          {"after", json_number(p.after)},
          {"std", json_number(p.std)}};
}

Json regime_json(const GapRegime& regime) {
  return {{"regime", regime.name},
          {"share_of_time", json_number(regime.share_of_time)},
          {"share_of_excess_error", json_number(regime.share_of_excess_error)}};
}

Json experiment_json(const NextExperiment& next) {
  if (next.name.empty()) return nullptr;
  return {{"name", next.name}, {"separates", next.separates}};
}

Json candidate_json(const GapCandidate& c) {
  return {{"name", c.name},
          {"kind", c.kind == CandidateKind::Effect ? "effect" : "parameter"},
          {"round", c.round},
          {"score", json_number(c.score)},
          {"fitted", c.fitted},
          {"held_out_rmse_mm", json_number(c.held_out_rmse)},
          {"probability", json_number(c.probability)},
          {"chosen", c.chosen}};
}

Json data_json(const DataRemark& remark) {
  return {{"cause", remark.cause},
          {"channel", remark.channel},
          {"runs", remark.runs},
          {"blocks", remark.blocks},
          {"sentence", remark.sentence}};
}

Json comparison_json(const GapComparison& how) {
  return {{"free", how.free},
          {"window_s", how.window > 0.0 ? json_number(how.window) : Json(nullptr)},
          {"chosen_from_data", how.chosen},
          {"reason", how.reason},
          {"set_up", how.tissue ? "tissue" : "bench"},
          {"set_up_given", how.tissue_given}};
}

Json rejected_json(const RejectedName& rejected) {
  if (rejected.effects.empty()) return nullptr;
  return {{"effects", rejected.effects},
          {"gap_closed", json_number(rejected.gap_closed)},
          {"rmse_after_mm", json_number(rejected.rmse_after)},
          {"objections", rejected.objections}};
}

Json proposed_json(const std::optional<ProposedTerm>& term) {
  if (!term) return nullptr;
  return {{"name", term->name},
          {"expression", term->expression},
          {"coefficients", json_list(term->coefficients,
                                     [](const TermCoefficient& c) {
                                       return Json{{"name", c.name},
                                                   {"product", c.product},
                                                   {"unit", c.unit},
                                                   {"value", json_number(c.value)},
                                                   {"std", json_number(c.std)},
                                                   {"share_of_force", json_number(c.share)}};
                                     })},
          {"memory_s", term->memory_s > 0.0 ? json_number(term->memory_s) : Json(nullptr)},
          {"memory_std_s", term->memory_s > 0.0 ? json_number(term->memory_std) : Json(nullptr)},
          {"exponent", term->exponent > 0.0 ? json_number(term->exponent) : Json(nullptr)},
          {"exponent_std", term->exponent > 0.0 ? json_number(term->exponent_std) : Json(nullptr)},
          {"period_mm", term->period_mm > 0.0 ? json_number(term->period_mm) : Json(nullptr)},
          {"period_std_mm", term->period_mm > 0.0 ? json_number(term->period_std) : Json(nullptr)},
          {"seen", json_list(term->seen,
                             [](const TermVariableRange& range) {
                               return Json{{"variable", range.variable},
                                           {"unit", range.unit},
                                           {"low", json_number(range.low)},
                                           {"high", json_number(range.high)}};
                             })},
          {"rmse_mm",
           {{"before", json_number(term->rmse_before)},
            {"calibrated", json_number(term->rmse_calibrated)},
            {"after", json_number(term->rmse_after)}}},
          {"gap_closed", json_number(term->gap_closed)},
          {"meaning", term->meaning},
          {"rivals", term->rivals}};
}

Json shape_json(const ResidualShape& shape) {
  return {{"quantity", shape.quantity},
          {"unit", shape.unit},
          {"share_explained", json_number(shape.share_explained)},
          {"at", numbers(shape.at)},
          {"mean_mm", numbers(shape.mean)},
          {"count", numbers(shape.count)}};
}

Json fit_json(const RunFit& fit) {
  return {{"run", fit.run},
          {"held_out", fit.held_out},
          {"before_percent", json_number(fit.before_percent)},
          {"after_percent", json_number(fit.after_percent)},
          {"whiteness", json_number(fit.whiteness)},
          {"input_correlation", json_number(fit.input_correlation)},
          {"bound", json_number(fit.bound)}};
}

Json straw_man_json(const StrawMan& one) {
  return {{"name", one.name}, {"order", one.order}, {"rmse_mm", json_number(one.rmse)}};
}

Json margin_json(const MarginChange& m) {
  return {{"plan", m.plan},
          {"quantity", m.quantity},
          {"unit", m.unit},
          {"limit", json_number(m.limit)},
          {"before", json_number(m.before)},
          {"after", json_number(m.after)},
          {"ok", m.ok}};
}

}  // namespace

std::string gap_json(const GapFinding& f) {
  Json report = {
      {"verdict", label(f.verdict)},
      {"effects", json_list(f.effects, effect_json)},
      {"parameters_changed", json_list(f.parameters_changed, changed_json)},
      {"rmse_mm",
       {{"before", json_number(f.rmse_before)},
        {"after", json_number(f.rmse_after)},
        {"noise_floor", json_number(f.noise_floor)}}},
      {"gap_closed", json_number(f.gap_closed)},
      {"where", json_list(f.where, regime_json)},
      {"next_experiment", experiment_json(f.next)},
      {"held_out_runs", f.held_out_runs},
      {"seconds", json_number(f.seconds)},
      {"sentence", f.sentence},
      {"training_runs", f.training_runs},
      {"candidates", json_list(f.candidates, candidate_json)},
      {"shapes", json_list(f.shapes, shape_json)},
      {"margins", json_list(f.margins, margin_json)},
      {"warnings", f.warnings},
      {"noise_floor_std_mm", f.noise_given ? Json(nullptr) : json_number(f.noise_std)},
      {"partial", f.partial},
      {"rejected", rejected_json(f.rejected)},
      {"comparison", comparison_json(f.comparison)},
      {"data", json_list(f.data, data_json)},
      {"fits", json_list(f.fits, fit_json)},
      {"straw_men", json_list(f.straw_men, straw_man_json)},
      {"proposed", proposed_json(f.proposed)},
  };
  if (f.interrupted) report["interrupted"] = true;
  return json_file(report);
}

}  // namespace biopsy::report
