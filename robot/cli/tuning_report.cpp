#include "robot/cli/tuning_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "robot/common/text/number_text.hpp"
#include "sim/paper/tuning/respects.hpp"

namespace biopsy::robot {
namespace {

using Json = nlohmann::ordered_json;
using sim::tuning::EvaluatedGains, sim::tuning::Margins, sim::tuning::Score, sim::tuning::Tuning;

std::vector<EvaluatedGains> all_of(const Tuning& tuning) {
  std::vector<EvaluatedGains> all = tuning.evaluated;
  if (tuning.improved) all.push_back(*tuning.improved);
  return all;
}

double kp(const EvaluatedGains& evaluated) {
  return evaluated.gains.proportional_V_per_mm * 1e-3;
}

double ki(const EvaluatedGains& evaluated) {  // kV/mm a tick
  return evaluated.gains.integral_V_per_mm_per_tick * 1e-3;
}

double ki_per_second(const EvaluatedGains& evaluated) {  // kV/(mm s)
  return 1e3 * ki(evaluated);
}

std::string decibels(double value) {
  return std::isfinite(value) ? fmt::format("{:.1f} dB", value) : "none crosses";
}

std::string degrees(double value) {
  return std::isfinite(value) ? fmt::format("{:.0f}°", value) : "none crosses";
}

std::vector<std::string> margin_row(const std::string& name, const std::string& where, const Margins& m) {
  return {name,
          where,
          decibels(m.gain_dB),
          degrees(m.phase_degrees),
          fmt::format("{:.2f} Hz", m.crossover_Hz),
          m.stable ? "holds" : "does not hold"};
}

std::vector<std::string> score_row(const std::string& name, const std::string& where, const Score& s) {
  return {name,
          where,
          fmt::format("{:.3f} mm", s.settled_rmse),
          fixed(s.overshoot, 1, "%"),
          fixed(s.undershoot, 1, "%"),
          fmt::format("{:.2f} s", s.settling),
          fmt::format("{:.3f} mm", s.sine_rmse),
          fmt::format("{:.1f} kV", s.highest),
          fmt::format("{:.2f}", s.cost())};
}

report::StudyTable gains_table(const Tuning& tuning) {
  report::StudyTable table{"Gains", {"Controller", ">K_p, kV/mm", ">K_i, kV/(mm s)", "Feed-forward"}, {}};
  for (const EvaluatedGains& one : all_of(tuning))
    table.rows.push_back(
        {one.name, fmt::format("{:.3f}", kp(one)), fmt::format("{:.2f}", ki_per_second(one)),
         one.feed ? fmt::format("from the model, target limited to {:.0f} mm/s", one.speed) : "none"});
  return table;
}

report::StudyTable margins_table(const Tuning& tuning) {
  report::StudyTable table{
      "Margins of the loop", {"Controller", "Depth", ">Gain", ">Phase", ">Crossover", "Closed loop"}, {}};
  for (const EvaluatedGains& one : all_of(tuning)) {
    if (one.feed) continue;
    for (std::size_t i = 0; i < tuning.depths.size(); ++i)
      table.rows.push_back(margin_row(one.name, fmt::format("{:.0f} mm", tuning.depths[i]), one.at_depth[i]));
    table.rows.push_back(margin_row(one.name, "worst of all depths and stages", one.worst_margins));
  }
  return table;
}

report::StudyTable scores_table(const Tuning& tuning) {
  report::StudyTable table{"In time, with friction, hysteresis and noise",
                           {"Controller", "Stage", ">RMSE, settled", ">Overshoot, up", ">Down", ">Settling",
                            ">RMSE, sine", ">Highest", ">Cost"},
                           {}};
  table.rows.push_back(
      {"the paper's own stage", "measured", "0.077 mm", "< 10 %", "–", "1 s", "0.211 mm", "–", "–"});
  for (const EvaluatedGains& one : all_of(tuning)) {
    table.rows.push_back(score_row(one.name, "the model", one.nominal));
    table.rows.push_back(score_row(one.name, "worst of all stages", one.worst));
  }
  return table;
}

// JSON knows no infinity: a margin that nothing crosses is null.
Json json_of(const Margins& m) {
  const auto finite = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  return {{"gain_dB", finite(m.gain_dB)},
          {"phase_degrees", finite(m.phase_degrees)},
          {"crossover_Hz", m.crossover_Hz},
          {"stable", m.stable}};
}

Json json_of(const Score& s) {
  return {{"settled_rmse_mm", s.settled_rmse},
          {"overshoot_percent", s.overshoot},
          {"undershoot_percent", s.undershoot},
          {"settling_s", s.settling},
          {"sine_rmse_mm", s.sine_rmse},
          {"highest_kV", s.highest},
          {"cost", s.cost()}};
}

Json json_of(const EvaluatedGains& evaluated, const std::vector<double>& depths) {
  Json at_depth = Json::array();
  for (std::size_t i = 0; i < depths.size(); ++i) {
    Json entry = json_of(evaluated.at_depth[i]);
    entry["depth_mm"] = depths[i];
    at_depth.push_back(entry);
  }
  return {{"name", evaluated.name},
          {"K_p_kV_per_mm", kp(evaluated)},
          {"K_i_kV_per_mm_per_tick", ki(evaluated)},
          {"feed_forward", evaluated.feed},
          {"target_speed_mm_s", evaluated.feed ? Json(evaluated.speed) : Json(nullptr)},
          {"margins", at_depth},
          {"worst_margins", json_of(evaluated.worst_margins)},
          {"score", json_of(evaluated.nominal)},
          {"worst_score", json_of(evaluated.worst)}};
}

// What the margin costs.
std::string price(const EvaluatedGains& paper, const EvaluatedGains& tuned) {
  return fmt::format("Against the paper's, {}.",
                     sim::tuning::comparison_text(sim::tuning::respects(paper, tuned)));
}

std::string improvement(const Tuning& tuning) {
  const std::string within = fmt::format("more than {:.0f} %", 100.0 * sim::tuning::kNoticed);
  if (!tuning.improved)
    return fmt::format(
        "No gains within a half to two times the paper's are better in one respect by {} without being worse "
        "in "
        "another by as much.",
        within);
  const EvaluatedGains& one = *tuning.improved;
  return fmt::format("K_p = {:.2f} kV/mm and K_i = {:.2f} kV/(mm s) improve on the paper's gains: {}.",
                     kp(one), ki_per_second(one),
                     sim::tuning::comparison_text(sim::tuning::respects(tuning.evaluated.front(), one)));
}

std::string with_feed(const Tuning& tuning) {
  if (tuning.interrupted) return "Feed-forward was not evaluated: the search was interrupted.";
  std::string text =
      "With feed-forward, settled and on the sine, the paper's own stage reaching 0.077 and 0.211 mm:";
  for (const EvaluatedGains& one : tuning.evaluated)
    if (one.feed)
      text += fmt::format(
          " {} {:.3f} and {:.3f} mm on the model, {:.3f} and {:.3f} mm on the worst stage, with {} of "
          "margin;",
          one.name.substr(0, one.name.find(',')), one.nominal.settled_rmse, one.nominal.sine_rmse,
          one.worst.settled_rmse, one.worst.sine_rmse, decibels(one.worst_margins.gain_dB));
  text.back() = '.';
  return text;
}

}  // namespace

std::string tuning_sentence(const Tuning& tuning) {
  const EvaluatedGains &paper = tuning.evaluated.at(0), &tuned = tuning.evaluated.at(1);
  const std::string wanted = fmt::format(
      "{:.0f} dB and {:.0f}° on the model and on {} drawn from its uncertainty", tuning.wanted.gain_dB,
      tuning.wanted.phase_degrees, counted(static_cast<std::size_t>(tuning.stages), "stage"));
  const std::string gains =
      fmt::format("K_p = {:.2f} kV/mm and K_i = {:.2f} kV/(mm s)", kp(tuned), ki_per_second(tuned));
  const std::string papers =
      fmt::format("the paper's 0.8 and 5 have {} and {} in the worst case",
                  decibels(paper.worst_margins.gain_dB), degrees(paper.worst_margins.phase_degrees));
  if (!tuning.met)
    return fmt::format("No gains keep {}; {} come closest, with {} and {}; {}.", wanted, gains,
                       decibels(tuned.worst_margins.gain_dB), degrees(tuned.worst_margins.phase_degrees),
                       papers);
  return fmt::format("{} keep {}; {}. {}", gains, wanted, papers, price(paper, tuned));
}

report::StudyPage tuning_page(const Tuning& tuning, const std::string& model) {
  report::StudyPage page;
  page.title = "Gains of the PI loop";
  page.sentence =
      (tuning.interrupted ? "Interrupted before the search was complete. " : "") + tuning_sentence(tuning);
  page.doubted = !tuning.met || tuning.interrupted;
  page.remarks = {
      improvement(tuning),
      fmt::format(
          "Model: {}. Uncertain: {}{}. They are drawn {}; {} refused because "
          "the paper's "
          "own stage rules them out: with its gains they do not settle to twice its 0.077 mm. So the paper's "
          "worst case is that of stages which its gains can drive.",
          model, fmt::join(tuning.varied, ", "),
          tuning.assumed ? " (by 10 %: the model file gives no standard deviations)" : "",
          tuning.correlated ? "with the file's correlations" : "independently",
          counted(static_cast<std::size_t>(tuning.refused), "further draw") +
              (tuning.refused == 1 ? " was" : " were")),
      "Margins are those of the stage without friction, play and tissue, for motions that are large against "
      "both; "
      "what these do is in the courses in time. Cost adds the errors in units of what the paper reports of "
      "its own "
      "stage, so that 4 is as good as the paper.",
      "Feed-forward is shown beside the loop. No other command uses it. " + with_feed(tuning)};
  page.tables = {gains_table(tuning), scores_table(tuning), margins_table(tuning)};
  page.panels = tuning.panels;
  return page;
}

std::string tuning_json(const Tuning& tuning, const std::string& model, double seconds) {
  Json controllers = Json::array();
  for (const EvaluatedGains& one : tuning.evaluated) controllers.push_back(json_of(one, tuning.depths));
  Json all = {
      {"model", model},
      {"met", tuning.met},
      {"wanted", {{"gain_dB", tuning.wanted.gain_dB}, {"phase_degrees", tuning.wanted.phase_degrees}}},
      {"uncertain", tuning.varied},
      {"uncertainty_assumed", tuning.assumed},
      {"stages", tuning.stages},
      {"refused", tuning.refused},
      {"controllers", controllers},
      {"improved", tuning.improved ? json_of(*tuning.improved, tuning.depths) : Json(nullptr)},
      {"seconds", seconds}};
  if (tuning.interrupted) all["interrupted"] = true;
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace biopsy::robot
