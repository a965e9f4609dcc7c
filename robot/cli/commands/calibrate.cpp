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
#include "robot/report/study/calibration_report.hpp"
#include "sim/paper/calibration/leave_one_out.hpp"
#include "sim/paper/calibration/paper_text.hpp"
#include "sim/plant/model_text.hpp"

namespace biopsy::robot {
namespace calibrate_cli {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using sim::calibration::CalibratedParameter;
using sim::calibration::Calibration;

// With the starts from far away as many as ten minutes of two processors allow: 600 met no more rows
// than 300. Measured runs alone cost a thousandth of the figures.
constexpr int kEvaluations = 600, kEvaluationsFar = 300;
constexpr int kStartsOfFigures = 2, kStartsAlone = 4;
constexpr int kStepsWithout = 6;  // of a calibration without a figure
// Along the sensitivities: of measured runs alone, which cost a thousandth of the figures.
constexpr int kFarSteps = 6, kLastSteps = 3, kStepsAlone = 30;
constexpr double kWideSpread = 0.2, kNarrowSpread = 0.1;  // prior standard deviations

struct Options {
  fs::path model;  // empty: sim/models/calibrated.toml
  fs::path out;
  std::vector<fs::path> data;       // measured runs that count beside the paper's rows
  std::vector<fs::path> only_mine;  // measured runs that count alone
  int evaluations = 0;              // 0: as many as the search needs from where it begins
  int starts = 0;                   // 0: several from nominal values and for measured runs alone, else none
  std::uint64_t seed = 1;
  bool from_nominal = false;   // begin at what was known beforehand, not at earlier answers
  bool leave_one_out = false;  // held_out.toml in place of a model
};

void declare(CLI::App& app, Options& options) {
  add_model(app, options.model, "numbers that are not searched, such as the sensor's",
            "sim/models/calibrated.toml");
  add(app, "--data FOLDER", options.data,
      "folder of a [data set](model-files.md#data-set) that counts beside the paper; may be repeated");
  CLI::Option* mine = add(app, "--only-mine FOLDER", options.only_mine,
                          "folder of a [data set](model-files.md#data-set) of a stage of your own: fitted "
                          "alone, without the paper's "
                          "figures, from the values of `--model`; may be repeated");
  add(app, "--evaluations N", options.evaluations, "budget of the global search",
      "300 with `--from-nominal`, else 600")
      ->check(in_range(1, 1'000'000));
  add(app, "--starts N", options.starts,
      "starts of a first search from far away: the nominal values and draws around them",
      "2 with `--from-nominal`, 4 with `--only-mine`, else none")
      ->check(in_range(1, 1000));
  add_seed(app, options.seed, "the search");
  CLI::Option* nominal = app.add_flag("--from-nominal", options.from_nominal,
                                      "begin at the nominal values, not at the result of earlier searches");
  app.add_flag("--leave-one-out", options.leave_one_out,
               "predict each figure by a calibration on all others, from the nominal values, and write "
               "held_out.toml")
      ->excludes(nominal)
      ->excludes(mine);
  mine->excludes(nominal);
  add_out(app, options.out, "the result")->required();
}

double three_digits(double value) {
  return std::stod(fmt::format("{:.2e}", value));
}

bool is_of_stage(const std::string& name) {
  return !name.starts_with("film.") && !name.starts_with("joint.");
}

std::vector<sim::RecordedRun> runs_in(const std::vector<fs::path>& folders) {
  std::vector<sim::RecordedRun> runs;
  for (const fs::path& folder : folders)
    for (sim::RecordedRun& run : sim::read_dataset(folder, sim::Drive::Stack).runs)
      runs.push_back(std::move(run));
  return runs;
}

// Parameters of the stage itself, known beforehand as `model` has them.
std::vector<sim::calibration::Parameter> parameters_of(const sim::paper::PaperModel& model) {
  std::vector<sim::calibration::Parameter> parameters;
  for (sim::calibration::Parameter parameter : sim::calibration::standard_parameters()) {
    if (!is_of_stage(parameter.name)) continue;
    const double value = sim::calibration::value_of(model, parameter.name);
    if (value >= parameter.low && value <= parameter.high) parameter.nominal = value;
    parameter.start = parameter.nominal;
    parameters.push_back(parameter);
  }
  return parameters;
}

sim::calibration::Question question_of(const Options& options) {
  sim::calibration::Question question;
  question.start = sim::paper::read_paper_model(options.model, data_folder() / "sim/models/paper.toml");
  if (!options.only_mine.empty()) {
    question.parameters = parameters_of(question.start);
    question.runs = runs_in(options.only_mine);
    return question;
  }
  question.parameters = sim::calibration::standard_parameters();
  if (options.from_nominal)
    for (sim::calibration::Parameter& parameter : question.parameters) parameter.start = parameter.nominal;
  question.figures = sim::calibration::calibrated_figures();
  question.reach = sim::calibration::kReach;
  question.runs = runs_in(options.data);
  return question;
}

Calibration calibrated(const sim::calibration::Question& question, const Options& options,
                       const std::stop_token& stop) {
  const bool alone = !options.only_mine.empty();
  ProgressLine line;
  return sim::calibration::calibrate(
      question,
      {.starts = options.starts,
       .far_steps = alone ? kStepsAlone : kFarSteps,
       .evaluations = options.evaluations,
       .last_steps = alone ? kStepsAlone : kLastSteps,
       .seed = options.seed,
       .spread = options.starts > 0 ? kNarrowSpread : kWideSpread,
       .stop = stop},
      [&line](double share, const std::string& doing) { line.show(share, doing); });
}

std::string command_of(const Options& options) {
  std::string command =
      fmt::format("biopsy calibrate --evaluations {} --seed {}", options.evaluations, options.seed);
  if (options.from_nominal) command += " --from-nominal";
  if (options.starts > 0) command += fmt::format(" --starts {}", options.starts);
  return command;
}

std::string source_of(const Options& options, const Calibration& result) {
  std::string source = "fitted by " + command_of(options) + ": ";
  if (options.only_mine.empty()) source += "the paper's figures 6 to 13";
  for (const fs::path& folder : options.data) source += ", " + folder.filename().string();
  for (std::size_t i = 0; i < options.only_mine.size(); ++i)
    source += (i > 0 ? ", " : "") + options.only_mine[i].filename().string();
  if (result.kept_start) source += ", which found nothing better than its start";
  if (result.interrupted) source += ", interrupted";
  return source;
}

// Of the numbers found; the others keep the notes of the model that was started from.
sim::ModelNotes notes_of(const Calibration& result, sim::ModelNotes notes, const std::string& source,
                         bool mine) {
  for (const CalibratedParameter& found : result.parameters)
    notes.values[found.parameter.name] = {
        std::isfinite(found.std) ? std::optional(three_digits(found.std)) : std::nullopt,
        source + (found.only_prior ? ", from which it is not identifiable: its std is the prior's" : "") +
            "; prior: " + found.parameter.why};
  notes.title = mine ? "SE-HASEL needle stage, calibrated on its own measured runs"
                     : "SE-HASEL needle stage, calibrated on the paper's figures";
  return notes;
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
  const sim::ModelNotes notes =
      notes_of(result, given, source_of(options, result), !options.only_mine.empty());
  sim::ModelNotes stage_notes = notes;
  std::erase_if(stage_notes.values, [](const auto& entry) { return !is_of_stage(entry.first); });
  if (!result.interrupted) stage_notes.correlations = correlations_of_stage(result);
  atomic_write(options.out / "calibrated.toml", sim::model_toml(result.model.stage, stage_notes));
  if (options.only_mine.empty())
    atomic_write(options.out / "paper.toml", sim::calibration::paper_toml(result.model, notes));
}

// Each figure predicted by the others, beside the model that is there.
Result leave_one_out(const Options& options, const sim::calibration::Question& question,
                     const Context& context) {
  ProgressLine line;
  sim::paper::HeldOut found = sim::calibration::leave_one_out(
      question, kStepsWithout, [&line](double share, const std::string& doing) { line.show(share, doing); },
      context.interrupted);
  found.command = "biopsy calibrate --leave-one-out";
  found.model = sim::paper::digests_of(options.model, data_folder() / "sim/models/paper.toml");
  atomic_write(options.out / "held_out.toml", sim::paper::held_out_toml(found));
  std::size_t ok = 0;
  Json rows = Json::array();
  std::string text;
  for (const sim::paper::HeldOutRow& row : found.rows) {
    ok += row.ok ? 1 : 0;
    if (!row.ok) text += fmt::format("  missed: {} {}: {:.4g}\n", row.figure, row.quantity, row.ours);
    rows.push_back(
        {{"figure", row.figure}, {"quantity", row.quantity}, {"held_out", row.ours}, {"ok", row.ok}});
  }
  text += fmt::format("{} of {} rows met by calibrations without their figure\n\nrows: {}\n", ok,
                      found.rows.size(), (options.out / "held_out.toml").string());
  return {.text = text, .json = Json{{"rows", rows}}.dump(2) + "\n"};
}

Result run(const Options& given, const Context& context) {
  Options options = given;
  if (options.model.empty()) options.model = data_folder() / "sim/models/calibrated.toml";
  if (options.evaluations == 0) options.evaluations = options.from_nominal ? kEvaluationsFar : kEvaluations;
  if (options.starts == 0 && options.from_nominal) options.starts = kStartsOfFigures;
  if (options.starts == 0 && !options.only_mine.empty()) options.starts = kStartsAlone;
  const sim::calibration::Question question = question_of(options);
  const sim::ModelNotes given_notes = sim::read_noted_model(options.model).notes;
  Inputs inputs = options.data;
  inputs.insert(inputs.end(), options.only_mine.begin(), options.only_mine.end());
  inputs.push_back(options.model);
  claim_run_folder(options.out, inputs, context.clearable);
  if (options.leave_one_out) return leave_one_out(options, question, context);
  const auto started = std::chrono::steady_clock::now();
  const Calibration result = calibrated(question, options, context.interrupted);
  const report::CalibrationRun about{
      command_of(options), options.seed,
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count(),
      options.only_mine.empty() ? options.data : options.only_mine, options.out};
  const std::string json = report::calibration_json(result, about);
  write_models(result, given_notes, options);
  atomic_write(options.out / "report.html", report::calibration_html(result, about));
  atomic_write(options.out / "calibration.json", json);
  const std::string films =
      options.only_mine.empty() ? fmt::format("films:  {}\n", (options.out / "paper.toml").string()) : "";
  return {.text = report::calibration_text(result, about) +
                  fmt::format("\nstage:  {}\n{}report: {}\nvalues: {}\n",
                              (options.out / "calibrated.toml").string(), films,
                              (options.out / "report.html").string(),
                              (options.out / "calibration.json").string()),
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
          "most of the paper's rows. Measured runs given by `--data` count beside the paper's; those given "
          "by "
          "`--only-mine` alone. "
          "Nothing in sim/models is touched: copy both models there to adopt them. The same seed "
          "and number of evaluations give the same result.",
      .long_examples = {"biopsy calibrate --out out/calibrated",
                        "biopsy calibrate --data measured --out out/calibrated",
                        "biopsy calibrate --from-nominal --out out/calibrated",
                        "biopsy calibrate --leave-one-out --out out/held-out"},
      .exit_codes =
          "0, 2 for unusable input, 130 where Ctrl-C ended the search; the best set until then is "
          "written, without standard deviations",
      .outputs = {{"calibrated.toml",
                   "the [model](model-files.md#model), with standard deviations, correlations and sources"},
                  {"paper.toml", "the other films and the joint; not with `--only-mine`"},
                  {"report.html", "the parameters, which of them the data tell, and what is missed"},
                  {"held_out.toml",
                   "with `--leave-one-out`, and then alone: each row by the calibration without its figure; "
                   "`biopsy reproduce` shows `sim/models/held_out.toml` beside the model that it names"},
                  {"calibration.json", "[the numbers for programs](#calibrationjson)"}},
      .replaces_earlier_run = true,
      .json = "the content of [calibration.json](#calibrationjson)",
      .interruptible = true,
      .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
