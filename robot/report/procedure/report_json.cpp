#include <cmath>

#include "robot/common/text/number_text.hpp"
#include "robot/report/markup/json_values.hpp"
#include "robot/report/procedure/labels.hpp"
#include "robot/report/procedure/report.hpp"
#include "robot/report/procedure/verdict.hpp"

namespace biopsy::report {
namespace {

constexpr int kLengthDecimals = 4;  // 0.1 um: ten times finer than the laser's count

Json number(double value, int decimals = kLengthDecimals) {
  return json_number(std::isfinite(value) ? rounded(value, decimals) : value);
}

Json triple(const double (&values)[3]) {
  return {number(values[0]), number(values[1]), number(values[2])};
}

Json check_json(const DepthCheck& check) {
  return {
      {"verdict", label(check.verdict)},
      {"reason", check.reason},
      {"tip_found", check.tip_found},
      {"depth_mm", number(check.tip_found ? check.depth.value : kUnknown)},
      {"sigma_mm", number(check.tip_found ? check.sigma.value : kUnknown)},
      {"lateral_mm", number(check.tip_found ? check.lateral_mm : kUnknown)},
      {"lateral_sigma_mm", number(check.tip_found ? check.lateral_sigma_mm : kUnknown)},
      {"angle_deg", number(check.tip_found ? check.angle_deg : kUnknown)},
      {"angle_sigma_deg", number(check.tip_found ? check.angle_sigma_deg : kUnknown)},
      {"tip_offset_mm", number(check.tip_offset_known ? check.tip_offset_mm : kUnknown)},
      {"tip_offset_sigma_mm", number(check.tip_offset_known ? check.tip_offset_sigma_mm : kUnknown)},
      {"shift_mm", triple(check.shift_mm)},
      {"rotation_deg", triple(check.rotation_deg)},
      {"patient_motion_mm", number(check.patient_motion_mm.value_or(kUnknown))},
      {"registration_score", number(check.registration_score)},
      {"contrast_to_noise", number(check.contrast_to_noise)},
  };
}

Json step_json(const StepResult& result, std::size_t index) {
  return {
      {"number", index + 1},
      {"kind", label(result.step.kind)},
      {"depth_mm", number(result.step.depth.value)},
      {"speed_mm_s", number(result.step.speed.value)},
      {"v_max_kV", number(result.step.v_max.value * 1e-3)},
      {"dwell_s", number(result.step.dwell.count())},
      {"image_confirms", result.step.image_confirms},
      {"why", json_text(result.step.why)},
      {"reached", result.reached},
      {"reached_s", number(result.reached ? result.reached_s : kUnknown)},
      {"depth_reached_mm", number(result.depth_mm)},
      {"rmse_settled_mm", number(result.rmse_settled_mm)},
      {"overshoot_mm", number(result.overshoot_mm)},
      {"layer_at_tip", json_text(result.layer_at_tip)},
      {"image_s", number(result.image_s)},
      {"hv_switching_during_image", result.hv_switching_during_image},
      {"image_motion_mm", number(result.image_motion_mm)},
      {"image", json_text(result.image_path)},
      {"check", result.check ? check_json(*result.check) : Json(nullptr)},
  };
}

Json trip_json(const Trip& trip) {
  return {{"time_s", number(trip.time_s)}, {"stop", label(trip.stop)}, {"reason", trip.reason}};
}

Json controller_json(const PiGains& gains) {
  return {{"K_p_kV_per_mm", number(1e-3 * gains.proportional_V_per_mm)},
          {"K_i_kV_per_mm_s", number(gains.integral_V_per_mm_per_tick)}};
}

Json fault_json(const FaultResult& fault) {
  return {{"signal", fault.signal},
          {"kind", fault.kind},
          {"began_s", number(fault.began_s)},
          {"detected_by", fault.detected_by.empty() ? Json(nullptr) : Json(fault.detected_by)},
          {"detected_after_ms", number(fault.detected_after_ms)}};
}

Json limit_json(const LimitUse& use) {
  return {{"name", use.name},
          {"used", number(use.used)},
          {"limit", number(use.limit)},
          {"unit", use.unit},
          {"used_percent", number(used_percent(use), 1)}};
}

Json series_json(const RunRecord& record) {
  const SeriesIdentity& series = record.series;
  return {
      {"source", json_text(record.image_source)},
      {"patient_name", json_text(series.patient_name)},
      {"patient_id", json_text(series.patient_id)},
      {"study_uid", json_text(series.study_uid)},
      {"series_uid", json_text(series.series_uid)},
      {"frame_of_reference_uid", json_text(series.frame_of_reference_uid)},
      {"modality", json_text(series.modality)},
      {"description", json_text(series.description)},
      {"date", json_text(series.date)},
  };
}

// The fields other programs rely on: names and meaning are fixed.
Json interface_json(const RunRecord& record) {
  const bool moved = record.outcome != Outcome::Refused;
  const auto run_figure = [&](double value) { return number(moved ? value : kUnknown); };
  return {
      {"outcome", label(record.outcome)},
      {"refusal", json_text(record.refusal)},
      {"target_depth_mm", number(record.plan ? record.plan->target_depth.value : kUnknown)},
      {"final_depth_mm", run_figure(record.final_depth_mm)},
      {"left_depth_mm", run_figure(record.left_depth_mm)},
      {"image_depth_mm", run_figure(record.image_depth_mm)},
      {"image_depth_sigma_mm", run_figure(record.image_depth_sigma_mm)},
      {"layer_at_tip", moved ? json_text(record.layer_at_tip) : Json(nullptr)},
      {"rmse_settled_mm", run_figure(record.rmse_settled_mm)},
      {"rmse_all_mm", run_figure(record.rmse_all_mm)},
      {"overshoot_mm", run_figure(record.overshoot_mm)},
      {"peak_kV", run_figure(record.peak_kV)},
      {"true_depth_max_mm", run_figure(record.true_depth_max_mm)},
      {"faults", json_list(record.faults, fault_json)},
      {"controller", record.plan ? controller_json(record.plan->gains) : Json(nullptr)},
      {"trips", json_list(record.trips, trip_json)},
      {"stages", json_list(record.steps,
                           [&](const StepResult& step) {
                             return step_json(step, static_cast<std::size_t>(&step - record.steps.data()));
                           })},
      {"lost_ticks", record.lost_ticks},
      {"longest_gap_ms", number(record.longest_gap_ms)},
      {"ticks_left_out", record.ticks_left_out},
      {"unasked_holds", record.unasked_holds},
      {"simulated_s", number(record.simulated_s)},
      {"wall_s", number(record.wall_s)},
  };
}

}  // namespace

std::string report_json(const RunRecord& record) {
  Json report = interface_json(record);
  const DepthCheck* check = last_check(record);
  report["image_depth_verdict"] = check ? Json(label(check->verdict)) : Json(nullptr);
  report["title"] = record.title;
  report["verdict"] = verdict_sentence(record);
  report["remedy"] = json_text(record.remedy);
  report["simulated"] = record.simulated;
  report["seed"] = record.seed;
  report["series"] = series_json(record);
  report["warnings"] = record.image_warnings;
  report["registration"] = json_text(record.registration);
  report["limits"] = json_list(record.limits, limit_json);
  report["provenance"] = Json::object();
  for (const auto& [name, value] : record.provenance) report["provenance"][name] = value;
  return json_file(report);
}

}  // namespace biopsy::report
