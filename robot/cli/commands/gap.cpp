// biopsy gap: what a model is missing, from measured runs.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <optional>

#include "robot/cli/accepted_model.hpp"
#include "robot/cli/command.hpp"
#include "robot/cli/commands/gap_paper.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/procedure/recheck.hpp"
#include "robot/report/gap/gap_report.hpp"
#include "sim/gap/find_gap.hpp"
#include "sim/gap/fit/unknowns.hpp"
#include "sim/gap/select/evidence_runs.hpp"
#include "sim/plant/model_text.hpp"

namespace biopsy::robot {
namespace gap_cli {

namespace fs = std::filesystem;

struct Options {
  fs::path dataset, model, out;
  std::vector<std::string> free;        // baseline parameters that are not known
  std::optional<double> window;         // s; empty: each run from its start in one piece
  bool paper = false;                   // the paper's figures in place of a data set
  std::vector<std::string> candidates;  // of what these may lack; none: all
  bool as_given = false;                // neither is chosen from the data
  bool accept = false;                  // the model file is replaced by what was found
  bool recheck = true;                  // rehearse with the model that was found
};

void declare(CLI::App& app, Options& options) {
  CLI::Option* dataset = add(app, "DATASET", options.dataset,
                             "folder of a [data set](model-files.md#data-set). Required without `--paper`");
  add_model(app, options.model,
            "[model file](model-files.md#model); with `--paper` the numbers that are not searched. Required "
            "without `--paper`");
  add_out(app, options.out, "the report and the better model")->required();
  CLI::Option* paper = app.add_flag(
      "--paper", options.paper,
      "compare with the paper's figures in place of a data set: each candidate as extra unknowns of the "
      "calibration, every figure by a calibration on the others. Some 8,000 evaluations of all figures: "
      "more than an hour of two processors");
  paper->excludes(dataset);
  add(app, "--candidates NAMES", options.candidates,
      "with `--paper`: try these candidates alone, `second_creep,slow_unzipping`; a wrong name lists all",
      "all")
      ->delimiter(',')
      ->needs(paper);
  add(app, "--free NAMES", options.free,
      "numbers of `[baseline]` that are not known, `m,c_s,k`: fitted in every hypothesis")
      ->delimiter(',')
      ->excludes(paper);
  add(app, "--window SECONDS", options.window,
      "simulate in windows of this length, each from a free initial state",
      "each run in one piece; windows where a mechanism drifts")
      ->check(in_range(1e-3, 1e6, "s"))
      ->excludes(paper);
  app.add_flag("--as-given", options.as_given,
               "choose neither free numbers nor windows from the data: calibrated numbers, runs in one piece")
      ->excludes(paper);
  app.add_flag("--accept", options.accept,
               "replace the model file by the better model, or by the one with a proposed term; the old one "
               "stays beside it as `NAME.toml.1`, `.2` "
               "and so on")
      ->excludes(paper);
  app.add_flag_callback(
      "--no-recheck", [&options] { options.recheck = false; },
      "leave out the rehearsals of the built-in cases with the old and the better model");
}

// Before anything is cleared or written: whatever the search would refuse.
void refuse_unusable(const sim::Dataset& dataset, const sim::PlantModel& model, const Options& options) {
  sim::gap::baseline_hypothesis(model, options.free);
  if (options.window) sim::gap::check_window(dataset, *options.window);
  sim::gap::prepare(dataset, model, options.window, sim::gap::Sampling::Coarse);
}

// For one line of a terminal.
std::string shortened(const std::string& text) {
  constexpr std::size_t kMost = 76;
  return text.size() <= kMost ? text : text.substr(0, kMost - 4) + " ...";
}

// A data set without a title goes by the name of its folder.
std::string title_of(const sim::Dataset& dataset, const fs::path& folder) {
  return dataset.title.empty() ? fs::canonical(folder).filename().string() : dataset.title;
}

// Data set and runs: where the numbers of the new model come from.
std::string source_of(const sim::Dataset& dataset) {
  std::string source = dataset.title + ": ";
  for (std::size_t i = 0; i < dataset.runs.size(); ++i) source += (i == 0 ? "" : ", ") + dataset.runs[i].name;
  return source;
}

// Nobody knows a standard deviation better.
double rounded_to_three_digits(double value) {
  return std::stod(fmt::format("{:.2e}", value));
}

std::string new_text(const sim::PlantModel& model, const std::vector<sim::gap::FoundGap::Source>& changed,
                     sim::ModelNotes notes, const std::string& source) {
  for (const auto& [name, std] : changed) {
    sim::ValueNote& note = notes.values[name];
    note.std = std::isfinite(std) ? std::optional(rounded_to_three_digits(std)) : std::nullopt;
    note.source = source;
  }
  return sim::model_toml(model, notes);
}

bool is_better(const GapFinding& finding) {
  return finding.verdict == GapVerdict::Effect || finding.verdict == GapVerdict::Parameter;
}

// The model that --accept takes over: the better one, or the one with a proposed term; empty where there is
// none.
const std::string& acceptable_model(const GapFinding& finding) {
  return is_better(finding) ? finding.model_after : finding.model_proposed;
}

void add_recheck(GapFinding& finding, const Options& options, ProgressLine& line) {
  const fs::path file = options.out / (is_better(finding) ? "model.toml" : "proposed.toml");
  atomic_write(file, acceptable_model(finding));
  const Recheck checked = recheck(
      options.model, file, finding.noise_floor,
      [&line](double share, const std::string& what) { line.show(0.92 + 0.08 * share, "margins: " + what); });
  finding.margins = checked.margins;
  finding.warnings.insert(finding.warnings.end(), checked.warnings.begin(), checked.warnings.end());
}

std::string sentence_of(const GapFinding& finding) {
  if (!finding.interrupted) return report::verdict_sentence(finding);
  if (finding.verdict == GapVerdict::Unexplained)
    return fmt::format(
        "Interrupted before anything was found: model and measurement differ by {:.3g} mm where the noise is "
        "{:.3g} mm.",
        finding.rmse_before, finding.noise_floor);
  return "Interrupted; so far: " + report::verdict_sentence(finding);
}

GapFinding compared(const Options& options, const sim::Dataset& dataset, const sim::NotedModel& given,
                    const std::stop_token& stop) {
  const auto started = std::chrono::steady_clock::now();
  ProgressLine line;
  const sim::gap::FoundGap found = sim::gap::find_gap(
      dataset, given.model,
      {.free = options.free, .window = options.window, .choose = !options.as_given, .stop = stop},
      [&line](double share, const std::string& doing) { line.show(share, shortened(doing)); });
  GapFinding finding = found.finding;
  finding.dataset = dataset.title;
  finding.sentence = sentence_of(finding);
  finding.model_before = sim::model_toml(given.model, given.notes);
  finding.model_after = is_better(finding)
                            ? new_text(found.model, found.changed, given.notes, source_of(dataset))
                            : finding.model_before;
  if (found.proposed_model)
    finding.model_proposed =
        new_text(*found.proposed_model, found.proposed_changed, given.notes, source_of(dataset));
  if (options.recheck && !acceptable_model(finding).empty() && !finding.force_drive && !finding.interrupted)
    add_recheck(finding, options, line);
  finding.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return finding;
}

std::string accept(const GapFinding& finding, const fs::path& model) {
  if (acceptable_model(finding).empty() || finding.interrupted)
    return fmt::format("nothing to accept: {} stays as it was\n", model.string());
  const fs::path old = accept_model(model, acceptable_model(finding));
  return fmt::format("accepted: {} is now the new model; the old one is kept as {}\n", model.string(),
                     old.string());
}

void refuse_missing(const std::filesystem::path& given, const char* what, const char* which) {
  if (given.empty())
    throw ConfigError(fmt::format("{} is missing", what), "gap",
                      fmt::format("name {}, or compare with the paper's figures by --paper", which));
}

Result run(const Options& options, const Context& context) {
  if (options.paper) return gap_paper(options.model, options.candidates, options.out, context);
  refuse_missing(options.dataset, "DATASET", "the folder of a data set");
  refuse_missing(options.model, "--model", "a model file");
  const sim::NotedModel given = sim::read_noted_model(options.model);
  sim::Dataset dataset = sim::read_dataset(options.dataset, given.model.baseline.drive);
  dataset.title = title_of(dataset, options.dataset);
  refuse_unusable(dataset, given.model, options);
  if (options.accept) refuse_unless_replaceable(options.model);
  claim_run_folder(options.out, {options.dataset, options.model}, context.clearable);
  const GapFinding finding = compared(options, dataset, given, context.interrupted);
  report::save_gap(finding, options.out);
  const char* model = finding.proposed ? "proposed.toml" : "model.toml";
  std::string text = report::gap_console(finding) + fmt::format("\nreport: {}\nmodel:  {}\n",
                                                                (options.out / "report.html").string(),
                                                                (options.out / model).string());
  if (options.accept) text += accept(finding, options.model);
  return {.text = text, .json = report::gap_json(finding)};
}

}  // namespace gap_cli

Command gap_command() {
  using namespace gap_cli;
  return {
      .name = "gap",
      .summary = "what a model is missing, from measured runs",
      .description =
          "Compares the model with every run of the data set, says where they disagree and which effect or "
          "parameter explains it, and shows on runs it did not use how far that closes the gap: [finding "
          "what a model is missing](../how-to/find-missing-effects.md). The same data and model give the "
          "same answer; nothing in it is "
          "random. `--paper` asks of the paper's figures what they lack: [what was "
          "found](../explanation/paper.md#what-the-figures-lack). A data set or model that lies in the place "
          "of the answer is refused.",
      .examples = {"biopsy gap docs/examples/gap --model docs/examples/gap/stage.toml --out "
                   "out/gap-example --no-recheck"},
      .long_examples = {"biopsy gap rig --model rig.toml --free m,c_s,k --window 0.5 --out out/rig",
                        "biopsy gap --paper --out out/paper-gap"},
      .exit_codes =
          "0 for any verdict, \"unexplained\" included; 2 for unusable input; 130 where Ctrl-C "
          "ended the search, with what was found until then written",
      .outputs =
          {{"report.html",
            "the report for people; [how to read it](../how-to/find-missing-effects.md#3-read-the-report)"},
           {"signals.csv",
            "of every row: run, role (train or test), input, measured displacement, that of the model before "
            "and after, and both residuals"},
           {"gap.json", "[the answer for programs](#gapjson)"},
           {"model.toml", "the better model. Where nothing was found, the model that was given"},
           {"proposed.toml",
            "only where no effect fits and [a term is "
            "proposed](../explanation/gap-search.md#a-proposed-term): "
            "the model with it"},
           {"paper_gap.json",
            "with `--paper`, and then beside report.html alone: [what the figures lack](#paper_gapjson)"}},
      .replaces_earlier_run = true,
      .json = "the content of [gap.json](#gapjson), or with `--paper` of [paper_gap.json](#paper_gapjson)",
      .interruptible = true,
      .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
