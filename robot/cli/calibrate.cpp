// biopsy calibrate: one parameter set for all of the paper's figures.
#include "sim/paper/calibration/calibrate.hpp"

#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "robot/cli/commands.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/procedure/case.hpp"
#include "sim/paper/calibration/paper_text.hpp"
#include "sim/plant/model_text.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using sim::calibration::CalibratedParameter;
using sim::calibration::Calibration;

constexpr int kEvaluations = 600, kEvaluationsFromFar = 1600;
// From far away, in many dimensions at once; near an earlier answer few draws go more ways in the same time.
constexpr int kFewDraws = 16, kManyDraws = 24;
constexpr double kWideSpread = 0.2, kNarrowSpread = 0.15;  // doubts; the first search has narrowed it down
constexpr double kWorthSaying = 0.7;  // correlation from which two numbers are hardly known apart

double three_digits(double value) {
  return std::stod(fmt::format("{:.2e}", value));
}

sim::calibration::Question question_of(const CalibrateOptions& options) {
  sim::calibration::Question question;
  question.start = sim::paper::read_paper_model(options.model, data_folder() / "sim/models/paper.toml");
  question.parameters = sim::calibration::standard_parameters();
  if (options.from_nominal)
    for (sim::calibration::Parameter& parameter : question.parameters) parameter.start = parameter.nominal;
  question.figures = sim::calibration::calibrated_figures();
  question.reach = sim::calibration::kReach;
  for (const fs::path& folder : options.data)
    for (sim::RecordedRun& run : sim::read_dataset(folder, sim::Drive::Stack).runs)
      question.runs.push_back(std::move(run));
  return question;
}

Calibration calibrated(const sim::calibration::Question& question, const CalibrateOptions& options) {
  ProgressLine line;
  return sim::calibration::calibrate(
      question,
      {.far = options.from_nominal ? options.evaluations : 0,
       .evaluations = options.evaluations,
       .seed = options.seed,
       .population = options.from_nominal ? kManyDraws : kFewDraws,
       .spread = options.from_nominal ? kNarrowSpread : kWideSpread},
      [&line](double share, const std::string& doing) { line.show(share, doing); });
}

std::string source_of(const CalibrateOptions& options, const Calibration& result) {
  std::string source =
      fmt::format("biopsy calibrate --evaluations {} --seed {}{}: the paper's figures 6 to 13",
                  options.evaluations, options.seed, options.from_nominal ? " --from-nominal" : "");
  for (const fs::path& folder : options.data) source += ", " + folder.filename().string();
  if (result.kept_start) source += ", found nothing better than its first guesses";
  return source;
}

// Of the numbers found; the others keep the notes of the model that was started from.
sim::ModelNotes notes_of(const Calibration& result, sim::ModelNotes notes, const std::string& source) {
  for (const CalibratedParameter& found : result.parameters)
    notes.values[found.parameter.name] = {
        three_digits(found.std),
        source + (found.only_prior ? ", which hardly tell it: its std is what was known before" : "") +
            "; known before: " + found.parameter.why};
  notes.title = "SE-HASEL needle stage, calibrated on the paper's figures";
  return notes;
}

bool is_of_stage(const std::string& name) {
  return !name.starts_with("film.") && !name.starts_with("joint.");
}

double three_decimals(double value) {
  return std::round(1e3 * value) / 1e3;
}

sim::Correlations correlations_of_stage(const Calibration& result) {
  sim::Correlations out;
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    if (!is_of_stage(result.parameters[i].parameter.name)) continue;
    const auto row = static_cast<Eigen::Index>(i);
    for (const Eigen::Index column : kept)
      out.lower.push_back(three_decimals(result.correlations(row, column)));
    out.values.push_back(result.parameters[i].parameter.name);
    kept.push_back(row);
  }
  return out;
}

void write_models(const Calibration& result, const sim::ModelNotes& given, const CalibrateOptions& options) {
  const sim::ModelNotes notes = notes_of(result, given, source_of(options, result));
  sim::ModelNotes stage_notes = notes;
  std::erase_if(stage_notes.values, [](const auto& entry) { return !is_of_stage(entry.first); });
  stage_notes.correlations = correlations_of_stage(result);
  atomic_write(options.out / "calibrated.toml", sim::model_toml(result.model.stage, stage_notes));
  atomic_write(options.out / "paper.toml", sim::calibration::paper_toml(result.model, notes));
}

Json row_json(const PaperRow& row) {
  return {{"figure", row.figure}, {"quantity", row.quantity}, {"unit", row.unit}, {"paper", row.paper},
          {"ours", row.ours},     {"band", row.band},         {"ok", row.ok},     {"note", row.note}};
}

std::string json_text(const Calibration& result, const CalibrateOptions& options, double seconds) {
  Json values = Json::array(), matrix = Json::array(), rows = Json::array();
  for (const CalibratedParameter& found : result.parameters)
    values.push_back({{"name", found.parameter.name},
                      {"value", found.value},
                      {"std", found.std},
                      {"nominal", found.parameter.nominal},
                      {"low", found.parameter.low},
                      {"high", found.parameter.high},
                      {"at_bound", found.at_bound},
                      {"only_prior", found.only_prior},
                      {"source", found.parameter.why}});
  for (Eigen::Index i = 0; i < result.correlations.rows(); ++i) {
    Json line = Json::array();
    for (Eigen::Index j = 0; j < result.correlations.cols(); ++j)
      line.push_back(three_decimals(result.correlations(i, j)));
    matrix.push_back(line);
  }
  for (const PaperRow& row : result.rows) rows.push_back(row_json(row));
  Json runs = Json::array();
  for (const sim::calibration::RunFit& run : result.runs)
    runs.push_back({{"name", run.name},
                    {"rms_mm", 1e3 * run.rms},
                    {"span_mm", 1e3 * run.span},
                    {"followed", run.followed}});
  const Json all = {{"values", values},
                    {"correlations", matrix},
                    {"rows", rows},
                    {"runs", runs},
                    {"kept_start", result.kept_start},
                    {"cost_before", result.before},
                    {"cost_after", result.after},
                    {"evaluations", result.evaluations},
                    {"seed", options.seed},
                    {"seconds", seconds}};
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void print_correlations(const Calibration& result) {
  for (Eigen::Index i = 0; i < result.correlations.rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      if (std::abs(result.correlations(i, j)) >= kWorthSaying)
        fmt::print("hardly known apart: {} and {} (correlation {:.2f})\n",
                   result.parameters[j].parameter.name, result.parameters[i].parameter.name,
                   result.correlations(i, j));
}

void print(const Calibration& result, double seconds) {
  fmt::print("{:<32} {:>10} {:>10} {:>10}\n", "", "value", "std", "nominal");
  for (const CalibratedParameter& found : result.parameters)
    fmt::print("{:<32} {:>10.4g} {:>10.2g} {:>10.4g}{}{}\n", found.parameter.name, found.value, found.std,
               found.parameter.nominal, found.at_bound ? "  at the edge of what is plausible" : "",
               found.only_prior ? "  hardly told by the figures" : "");
  print_correlations(result);
  std::size_t reached = 0;
  for (const PaperRow& row : result.rows) reached += row.ok ? 1 : 0;
  fmt::print("\nrows reached: {} of {} (fitted; biopsy reproduce judges the model)\n", reached,
             result.rows.size());
  for (const PaperRow& row : result.rows)
    if (!row.ok)
      fmt::print("  missed: {} {}: {:.4g} against {:.4g} {}\n", row.figure, row.quantity, row.ours, row.paper,
                 row.unit);
  if (result.kept_start)
    fmt::print("nothing better was found than the first guesses, the answer of earlier searches\n");
  fmt::print("{} evaluations, {:.0f} s\n", result.evaluations, seconds);
}

// A measured run that is not followed is a finding, as a row of the paper is.
void print_runs(const Calibration& result, const CalibrateOptions& options) {
  if (result.runs.empty()) return;
  bool all = true;
  fmt::print("\nmeasured runs, and what the model is away from them:\n");
  for (const sim::calibration::RunFit& run : result.runs) {
    fmt::print("  {:<28} {:.3f} mm rms of {:.2f} mm{}\n", run.name, 1e3 * run.rms, 1e3 * run.span,
               run.followed ? "" : ": not followed");
    all = all && run.followed;
  }
  if (all) return;
  fmt::print(
      "What is not followed to 5 % of its span is missing an effect, or is of another stage than the "
      "paper's:\n");
  for (const fs::path& folder : options.data)
    fmt::print("  biopsy gap {} --model {} --out {}\n", folder.string(),
               (options.out / "calibrated.toml").string(), (options.out.parent_path() / "gap").string());
}

}  // namespace

int calibrate(const CalibrateOptions& given) {
  CalibrateOptions options = given;
  if (options.model.empty()) options.model = data_folder() / "sim/models/calibrated.toml";
  if (options.evaluations == 0)
    options.evaluations = options.from_nominal ? kEvaluationsFromFar : kEvaluations;
  const sim::calibration::Question question = question_of(options);
  const sim::ModelNotes given_notes = sim::read_noted_model(options.model).notes;
  Inputs inputs = options.data;
  inputs.push_back(options.model);
  claim_run_folder(options.out, inputs);
  const auto started = std::chrono::steady_clock::now();
  const Calibration result = calibrated(question, options);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  write_models(result, given_notes, options);
  atomic_write(options.out / "calibration.json", json_text(result, options, seconds));
  print(result, seconds);
  print_runs(result, options);
  fmt::print("\nstage:  {}\nfilms:  {}\nvalues: {}\n", (options.out / "calibrated.toml").string(),
             (options.out / "paper.toml").string(), (options.out / "calibration.json").string());
  return 0;
}

}  // namespace biopsy::robot
