#include "robot/report/study/calibration_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/text/number_text.hpp"
#include "robot/report/markup/json_values.hpp"
#include "robot/report/study/paper_score.hpp"
#include "robot/report/study/study_html.hpp"

namespace biopsy::report {
namespace {

using sim::calibration::CalibratedParameter, sim::calibration::Calibration, sim::calibration::RunFit;

constexpr double kStrongCorrelation = 0.7;

struct Pair {
  std::string first, second;
  double correlation;
};

std::vector<Pair> strong_correlations(const Calibration& result) {
  std::vector<Pair> pairs;
  for (Eigen::Index i = 0; i < result.correlations.rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      if (std::abs(result.correlations(i, j)) >= kStrongCorrelation)
        pairs.push_back({result.parameters[static_cast<std::size_t>(j)].parameter.name,
                         result.parameters[static_cast<std::size_t>(i)].parameter.name,
                         result.correlations(i, j)});
  return pairs;
}

std::size_t reached(const Calibration& result) {
  return static_cast<std::size_t>(
      std::count_if(result.rows.begin(), result.rows.end(), [](const PaperRow& row) { return row.ok; }));
}

std::string remark(const CalibratedParameter& found) {
  std::string text = found.at_bound ? "at the bound of its plausible range" : "";
  if (found.only_prior) text += std::string(text.empty() ? "" : "; ") + "not identifiable from these data";
  return text;
}

Json row_json(const PaperRow& row) {
  return {{"figure", row.figure}, {"quantity", row.quantity}, {"unit", row.unit}, {"paper", row.paper},
          {"ours", row.ours},     {"band", row.band},         {"ok", row.ok},     {"note", row.note}};
}

Json value_json(const CalibratedParameter& found) {
  return {{"name", found.parameter.name},       {"value", found.value},
          {"std", json_number(found.std)},      {"told_by_data", json_number(told_by_data(found))},
          {"nominal", found.parameter.nominal}, {"low", found.parameter.low},
          {"high", found.parameter.high},       {"at_bound", found.at_bound},
          {"only_prior", found.only_prior},     {"source", found.parameter.why}};
}

Json run_json(const RunFit& run) {
  return {
      {"name", run.name}, {"rms_mm", 1e3 * run.rms}, {"span_mm", 1e3 * run.span}, {"followed", run.followed}};
}

// A measured run that is not followed is a finding, as a row of the paper is.
std::string runs_text(const Calibration& result, const CalibrationRun& run) {
  if (result.runs.empty()) return {};
  bool all = true;
  std::string text = "\nmeasured runs, and their difference to the model:\n";
  for (const RunFit& fit : result.runs) {
    text += fmt::format("  {:<28} {:.3f} mm rms of {:.2f} mm{}\n", fit.name, 1e3 * fit.rms, 1e3 * fit.span,
                        fit.followed ? "" : ": not followed");
    all = all && fit.followed;
  }
  if (all) return text;
  text +=
      "What is not followed to 5 % of its span is missing an effect, or is of another stage than the "
      "paper's:\n";
  for (const std::filesystem::path& folder : run.data)
    text += fmt::format("  biopsy gap {} --model {} --out {}\n", folder.string(),
                        (run.out / "calibrated.toml").string(), (run.out.parent_path() / "gap").string());
  return text;
}

std::string missed_text(const Calibration& result) {
  std::string text;
  if (result.rows.empty()) return text;
  text = fmt::format("\nrows reached: {} of {} (fitted; biopsy reproduce judges the model)\n",
                     reached(result), result.rows.size());
  for (const PaperRow& row : result.rows)
    if (!row.ok)
      text += fmt::format("  missed: {} {}: {:.4g} against {:.4g} {}\n", row.figure, row.quantity, row.ours,
                          row.paper, row.unit);
  return text;
}

std::string told_sentence(const Calibration& result) {
  return fmt::format(
      "The data tell {} of {} independent combinations of the parameters; the others rest on the priors.",
      result.identifiability.told, result.parameters.size());
}

StudyTable parameters_table(const Calibration& result) {
  StudyTable table{
      "Parameters", {"Parameter", ">Value", ">Std", ">Nominal", ">Told by the data", "", "Prior"}, {}};
  for (const CalibratedParameter& found : result.parameters)
    table.rows.push_back(
        {found.parameter.name, fmt::format("{:.4g}", found.value),
         std::isfinite(found.std) ? fmt::format("{:.2g}", found.std) : "–",
         fmt::format("{:.4g}", found.parameter.nominal),
         std::isfinite(found.std) ? fmt::format("{:.0f} %", 100.0 * told_by_data(found)) : "–", remark(found),
         found.parameter.why});
  return table;
}

std::vector<StudyTable> tables(const Calibration& result) {
  std::vector<StudyTable> all{parameters_table(result)};
  StudyTable directions{
      "Combinations of parameters, best known first (in stds of the priors)", {">Std", "Combination"}, {}};
  for (const auto& direction : result.identifiability.directions)
    directions.rows.push_back({fmt::format("{:.2g}", direction.std), direction.parameters});
  StudyTable pairs{"Strongly correlated", {"Parameter", "Parameter", ">Correlation"}, {}};
  for (const Pair& pair : strong_correlations(result))
    pairs.rows.push_back({pair.first, pair.second, fmt::format("{:.2f}", pair.correlation)});
  StudyTable missed{
      "Rows of the paper that are missed", {"Figure", "Quantity", ">Paper", ">Ours", "Why"}, {}};
  for (const PaperRow& row : result.rows)
    if (!row.ok) missed.rows.push_back({row.figure, row.quantity, paper_text(row), ours_text(row), row.note});
  StudyTable runs{
      "Measured runs", {"Run", ">Difference, mm rms", ">Span, mm", "Followed to 5 % of the span"}, {}};
  for (const RunFit& run : result.runs)
    runs.rows.push_back({run.name, fmt::format("{:.3f}", 1e3 * run.rms),
                         fmt::format("{:.2f}", 1e3 * run.span), run.followed ? "yes" : "no"});
  for (StudyTable& table : std::vector{directions, pairs, missed, runs})
    if (!table.rows.empty()) all.push_back(std::move(table));
  return all;
}

FigurePanel told_panel(const Calibration& result) {
  const auto count = static_cast<double>(result.parameters.size());
  FigurePanel panel{"Told by the data, by the number of the parameter in the table",
                    "parameter",
                    "share of the variance",
                    0.5,
                    count + 0.5,
                    0.0,
                    1.05,
                    false,
                    {}};
  FigureCurve curve{"", {}, {}, false, true};
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    curve.x.push_back(static_cast<double>(i + 1));
    curve.y.push_back(told_by_data(result.parameters[i]));
  }
  panel.curves.push_back(std::move(curve));
  return panel;
}

}  // namespace

double told_by_data(const CalibratedParameter& found) {
  const double prior = found.parameter.doubt * (found.parameter.share ? 1.0 : found.value);
  return std::clamp(1.0 - std::pow(found.std / prior, 2), 0.0, 1.0);
}

std::string calibration_text(const Calibration& result, const CalibrationRun& run) {
  std::string text =
      fmt::format("{:<38} {:>10} {:>10} {:>10} {:>6}\n", "", "value", "std", "nominal", "told");
  for (const CalibratedParameter& found : result.parameters) {
    const std::string said = remark(found);
    text += fmt::format("{:<38} {:>10.4g} {:>10.2g} {:>10.4g} {:>4.0f} %{}{}\n", found.parameter.name,
                        found.value, found.std, found.parameter.nominal, 100.0 * told_by_data(found),
                        said.empty() ? "" : "  ", said);
  }
  for (const Pair& pair : strong_correlations(result))
    text +=
        fmt::format("strongly correlated: {} and {} ({:.2f})\n", pair.first, pair.second, pair.correlation);
  if (!result.interrupted) text += told_sentence(result) + "\n";
  text += missed_text(result);
  if (result.kept_start) text += "nothing better was found than the start, the result of earlier searches\n";
  if (result.interrupted) text += "interrupted: the best until then, without standard deviations\n";
  return text +
         fmt::format("{}, {:.0f} s\n", counted(static_cast<std::size_t>(result.evaluations), "evaluation"),
                     run.seconds) +
         runs_text(result, run);
}

std::string calibration_json(const Calibration& result, const CalibrationRun& run) {
  Json matrix = Json::array();
  for (Eigen::Index i = 0; i < result.correlations.rows(); ++i) {
    Json line = Json::array();
    for (Eigen::Index j = 0; j < result.correlations.cols(); ++j)
      line.push_back(std::round(1e3 * result.correlations(i, j)) / 1e3);
    matrix.push_back(line);
  }
  const auto direction = [](const auto& one) {
    return Json{{"std", json_number(one.std)}, {"parameters", one.parameters}};
  };
  Json all = {{"values", json_list(result.parameters, value_json)},
              {"correlations", matrix},
              {"directions", json_list(result.identifiability.directions, direction)},
              {"told", result.identifiability.told},
              {"rows", json_list(result.rows, row_json)},
              {"runs", json_list(result.runs, run_json)},
              {"kept_start", result.kept_start},
              {"cost_before", result.before},
              {"cost_after", result.after},
              {"evaluations", result.evaluations},
              {"seed", run.seed},
              {"seconds", run.seconds}};
  if (result.interrupted) all["interrupted"] = true;
  return json_file(all);
}

std::string calibration_html(const Calibration& result, const CalibrationRun& run) {
  StudyPage page;
  page.title = "Calibration of the stage";
  page.sentence = result.rows.empty()
                      ? fmt::format("Fitted to {} alone.", counted(result.runs.size(), "measured run"))
                      : fmt::format("{} of {} fitted rows of the paper reached by {} unknowns.",
                                    reached(result), result.rows.size(), result.parameters.size());
  page.doubted = result.interrupted;
  if (result.interrupted)
    page.remarks.push_back("Interrupted: the best until then, without standard deviations.");
  else
    page.remarks.push_back(told_sentence(result));
  page.remarks.push_back(
      "Told by the data: the share of a parameter's prior variance that the data take away. Standard "
      "deviations and "
      "correlations by the Fisher information of the rows at the result; a number of the paper counts with "
      "its band as "
      "its standard deviation, statements do not count.");
  page.remarks.push_back(fmt::format("{}; {}, {:.0f} s.", run.command,
                                     counted(static_cast<std::size_t>(result.evaluations), "evaluation"),
                                     run.seconds));
  page.tables = tables(result);
  if (!result.interrupted) page.panels.push_back(told_panel(result));
  return study_html(page);
}

}  // namespace biopsy::report
