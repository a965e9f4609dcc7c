// biopsy calibrate: one parameter set for all of the paper's figures.
#include "sim/paper/calibration/calibrate.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/common/text/number_text.hpp"
#include "sim/paper/calibration/paper_text.hpp"
#include "sim/plant/model_text.hpp"

namespace biopsy::robot {
namespace calibrate_cli {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using sim::calibration::CalibratedParameter;
using sim::calibration::Calibration;

struct Options {
  fs::path model;  // empty: sim/models/calibrated.toml
  fs::path out;
  std::vector<fs::path> data;  // measured runs that count beside the paper's rows
  int evaluations = 0;         // of each search; 0: 600, or 1600 from nominal values
  std::uint64_t seed = 1;
  bool from_nominal = false;  // begin at what was known beforehand, not at earlier answers
};

void declare(CLI::App& app, Options& options) {
  add_model(app, options.model, "numbers that are not searched, such as the sensor's",
            "sim/models/calibrated.toml");
  add(app, "--data FOLDER", options.data,
      "folder of a [data set](model-files.md#data-set) that counts beside the paper; may be repeated");
  add(app, "--evaluations N", options.evaluations, "budget of a global search",
      "600; `--from-nominal` has two searches, of 1600 each")
      ->check(in_range(1, 1'000'000));
  add_seed(app, options.seed, "the search");
  app.add_flag("--from-nominal", options.from_nominal,
               "begin at the nominal values, not at the result of earlier searches");
  add_out(app, options.out, "the result")->required();
}

constexpr int kEvaluations = 600, kEvaluationsFromFar = 1600;
// Population of CMA-ES: from the nominal values, and near an earlier result.
constexpr int kFewDraws = 16, kManyDraws = 24;
constexpr double kWideSpread = 0.2, kNarrowSpread = 0.15;  // prior standard deviations
constexpr double kStrongCorrelation = 0.7;

double three_digits(double value) {
  return std::stod(fmt::format("{:.2e}", value));
}

sim::calibration::Question question_of(const Options& options) {
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

Calibration calibrated(const sim::calibration::Question& question, const Options& options,
                       const std::stop_token& stop) {
  ProgressLine line;
  return sim::calibration::calibrate(
      question,
      {.far = options.from_nominal ? options.evaluations : 0,
       .evaluations = options.evaluations,
       .seed = options.seed,
       .population = options.from_nominal ? kManyDraws : kFewDraws,
       .spread = options.from_nominal ? kNarrowSpread : kWideSpread,
       .stop = stop},
      [&line](double share, const std::string& doing) { line.show(share, doing); });
}

std::string source_of(const Options& options, const Calibration& result) {
  std::string source =
      fmt::format("biopsy calibrate --evaluations {} --seed {}{}: the paper's figures 6 to 13",
                  options.evaluations, options.seed, options.from_nominal ? " --from-nominal" : "");
  for (const fs::path& folder : options.data) source += ", " + folder.filename().string();
  if (result.kept_start) source += ", which found nothing better than its start";
  if (result.interrupted) source += ", interrupted";
  return source;
}

// Of the numbers found; the others keep the notes of the model that was started from.
sim::ModelNotes notes_of(const Calibration& result, sim::ModelNotes notes, const std::string& source) {
  for (const CalibratedParameter& found : result.parameters)
    notes.values[found.parameter.name] = {
        std::isfinite(found.std) ? std::optional(three_digits(found.std)) : std::nullopt,
        source + (found.only_prior ? ", from which it is not identifiable: its std is the prior's" : "") +
            "; prior: " + found.parameter.why};
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
  for (std::size_t i = 0; i < result.parameters.size() && !result.interrupted; ++i) {
    if (!is_of_stage(result.parameters[i].parameter.name)) continue;
    const auto row = static_cast<Eigen::Index>(i);
    for (const Eigen::Index column : kept)
      out.lower.push_back(three_decimals(result.correlations(row, column)));
    out.values.push_back(result.parameters[i].parameter.name);
    kept.push_back(row);
  }
  return out;
}

void write_models(const Calibration& result, const sim::ModelNotes& given, const Options& options) {
  const sim::ModelNotes notes = notes_of(result, given, source_of(options, result));
  sim::ModelNotes stage_notes = notes;
  std::erase_if(stage_notes.values, [](const auto& entry) { return !is_of_stage(entry.first); });
  if (!result.interrupted) stage_notes.correlations = correlations_of_stage(result);
  atomic_write(options.out / "calibrated.toml", sim::model_toml(result.model.stage, stage_notes));
  atomic_write(options.out / "paper.toml", sim::calibration::paper_toml(result.model, notes));
}

Json row_json(const PaperRow& row) {
  return {{"figure", row.figure}, {"quantity", row.quantity}, {"unit", row.unit}, {"paper", row.paper},
          {"ours", row.ours},     {"band", row.band},         {"ok", row.ok},     {"note", row.note}};
}

std::string json_text(const Calibration& result, const Options& options, double seconds) {
  Json values = Json::array(), matrix = Json::array(), rows = Json::array();
  for (const CalibratedParameter& found : result.parameters)
    values.push_back({{"name", found.parameter.name},
                      {"value", found.value},
                      {"std", std::isfinite(found.std) ? Json(found.std) : Json(nullptr)},
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
  Json all = {{"values", values},
              {"correlations", matrix},
              {"rows", rows},
              {"runs", runs},
              {"kept_start", result.kept_start},
              {"cost_before", result.before},
              {"cost_after", result.after},
              {"evaluations", result.evaluations},
              {"seed", options.seed},
              {"seconds", seconds}};
  if (result.interrupted) all["interrupted"] = true;
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string correlations_text(const Calibration& result) {
  std::string text;
  for (Eigen::Index i = 0; i < result.correlations.rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      if (std::abs(result.correlations(i, j)) >= kStrongCorrelation)
        text += fmt::format("strongly correlated: {} and {} ({:.2f})\n", result.parameters[j].parameter.name,
                            result.parameters[i].parameter.name, result.correlations(i, j));
  return text;
}

std::string result_text(const Calibration& result, double seconds) {
  std::string text = fmt::format("{:<32} {:>10} {:>10} {:>10}\n", "", "value", "std", "nominal");
  for (const CalibratedParameter& found : result.parameters)
    text += fmt::format("{:<32} {:>10.4g} {:>10.2g} {:>10.4g}{}{}\n", found.parameter.name, found.value,
                        found.std, found.parameter.nominal,
                        found.at_bound ? "  at the bound of its plausible range" : "",
                        found.only_prior ? "  not identifiable from the figures" : "");
  text += correlations_text(result);
  std::size_t reached = 0;
  for (const PaperRow& row : result.rows) reached += row.ok ? 1 : 0;
  text += fmt::format("\nrows reached: {} of {} (fitted; biopsy reproduce judges the model)\n", reached,
                      result.rows.size());
  for (const PaperRow& row : result.rows)
    if (!row.ok)
      text += fmt::format("  missed: {} {}: {:.4g} against {:.4g} {}\n", row.figure, row.quantity, row.ours,
                          row.paper, row.unit);
  if (result.kept_start) text += "nothing better was found than the start, the result of earlier searches\n";
  if (result.interrupted) text += "interrupted: the best until then, without standard deviations\n";
  return text + fmt::format("{}, {:.0f} s\n",
                            counted(static_cast<std::size_t>(result.evaluations), "evaluation"), seconds);
}

// A measured run that is not followed is a finding, as a row of the paper is.
std::string runs_text(const Calibration& result, const Options& options) {
  if (result.runs.empty()) return {};
  bool all = true;
  std::string text = "\nmeasured runs, and their difference to the model:\n";
  for (const sim::calibration::RunFit& run : result.runs) {
    text += fmt::format("  {:<28} {:.3f} mm rms of {:.2f} mm{}\n", run.name, 1e3 * run.rms, 1e3 * run.span,
                        run.followed ? "" : ": not followed");
    all = all && run.followed;
  }
  if (all) return text;
  text +=
      "What is not followed to 5 % of its span is missing an effect, or is of another stage than the "
      "paper's:\n";
  for (const fs::path& folder : options.data)
    text +=
        fmt::format("  biopsy gap {} --model {} --out {}\n", folder.string(),
                    (options.out / "calibrated.toml").string(), (options.out.parent_path() / "gap").string());
  return text;
}

Result run(const Options& given, const Context& context) {
  Options options = given;
  if (options.model.empty()) options.model = data_folder() / "sim/models/calibrated.toml";
  if (options.evaluations == 0)
    options.evaluations = options.from_nominal ? kEvaluationsFromFar : kEvaluations;
  const sim::calibration::Question question = question_of(options);
  const sim::ModelNotes given_notes = sim::read_noted_model(options.model).notes;
  Inputs inputs = options.data;
  inputs.push_back(options.model);
  claim_run_folder(options.out, inputs, context.clearable);
  const auto started = std::chrono::steady_clock::now();
  const Calibration result = calibrated(question, options, context.interrupted);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  const std::string json = json_text(result, options, seconds);
  write_models(result, given_notes, options);
  atomic_write(options.out / "calibration.json", json);
  return {.text = result_text(result, seconds) + runs_text(result, options) +
                  fmt::format(
                      "\nstage:  {}\nfilms:  {}\nvalues: {}\n", (options.out / "calibrated.toml").string(),
                      (options.out / "paper.toml").string(), (options.out / "calibration.json").string()),
          .json = json};
}

}  // namespace calibrate_cli

Command calibrate_command() {
  using namespace calibrate_cli;
  return {
      .name = "calibrate",
      .summary = "one parameter set for all of the paper's figures",
      .description =
          "Searches the parameters of the stage, within plausible ranges, for the set that reaches "
          "most of the paper's rows. Measured runs given by `--data` count beside the paper's. "
          "Nothing in sim/models is touched: copy both models there to adopt them. The same seed "
          "and number of evaluations give the same result.",
      .long_examples = {"biopsy calibrate --out out/calibrated",
                        "biopsy calibrate --data measured --out out/calibrated"},
      .exit_codes =
          "0, 2 for unusable input, 130 where Ctrl-C ended the search; the best set until then is "
          "written, without standard deviations",
      .outputs = {{"calibrated.toml",
                   "the [model](model-files.md#model), with standard deviations, correlations and sources"},
                  {"paper.toml", "the other films and the joint"},
                  {"calibration.json", "[the numbers for programs](#calibrationjson)"}},
      .replaces_earlier_run = true,
      .json = "the content of [calibration.json](#calibrationjson)",
      .interruptible = true,
      .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
