// biopsy gap: what a model is missing, from measured runs.
#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "robot/cli/accepted_model.hpp"
#include "robot/cli/commands.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/files/whole_file.hpp"
#include "robot/common/progress.hpp"
#include "robot/procedure/recheck.hpp"
#include "robot/report/gap/gap_report.hpp"
#include "sim/gap/find_gap.hpp"
#include "sim/gap/fit/unknowns.hpp"
#include "sim/gap/select/evidence_runs.hpp"
#include "sim/plant/model_text.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

// Before anything is cleared or written: whatever the search would refuse.
void refuse_unusable(const sim::Dataset& dataset, const sim::PlantModel& model, const GapOptions& options) {
  sim::gap::baseline_hypothesis(model, options.free);
  if (options.window && !std::isfinite(*options.window))
    throw ConfigError("the window is no number of seconds", "--window", "give one, such as 0.5");
  for (const sim::RecordedRun& run : dataset.runs) {
    const double length = run.period * static_cast<double>(run.time.size());
    if (options.window && *options.window > length)
      throw ConfigError(fmt::format("a window of {} s is longer than run \"{}\", which has {:.3g} s",
                                    *options.window, run.name, length),
                        "--window",
                        "give a shorter window, or leave --window out to simulate each run in one piece");
    if (options.window && *options.window < 2.0 * run.period)
      throw ConfigError(
          fmt::format("a window of {} s holds less than two rows of run \"{}\", which come every "
                      "{} s",
                      *options.window, run.name, run.period),
          "--window", "give a longer window");
  }
  sim::gap::prepare(dataset, model, options.window, sim::gap::Grain::Coarse);
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

std::string new_text(const sim::gap::FoundGap& found, sim::ModelNotes notes, const std::string& source) {
  for (const auto& [name, std] : found.changed) {
    sim::ValueNote& note = notes.values[name];
    note.std = std::isfinite(std) ? std::optional(rounded_to_three_digits(std)) : std::nullopt;
    note.source = source;
  }
  return sim::model_toml(found.model, notes);
}

bool is_better(const GapFinding& finding) {
  return finding.verdict == GapVerdict::Effect || finding.verdict == GapVerdict::Parameter;
}

void add_recheck(GapFinding& finding, const GapOptions& options, ProgressLine& line) {
  report::atomic_write(options.out / "model.toml", finding.model_after);
  const Recheck checked =
      recheck(options.model, options.out / "model.toml", finding.noise_floor,
              [&line](double share, const std::string& what) { line.show(share, "margins: " + what); });
  finding.margins = checked.margins;
  finding.warnings.insert(finding.warnings.end(), checked.warnings.begin(), checked.warnings.end());
}

GapFinding compared(const GapOptions& options, const sim::Dataset& dataset, const sim::NotedModel& given) {
  const auto started = std::chrono::steady_clock::now();
  ProgressLine line;
  const sim::gap::FoundGap found =
      sim::gap::find_gap(dataset, given.model, {.free = options.free, .window = options.window},
                         [&line](const std::string& doing) { line.show(-1.0, shortened(doing)); });
  GapFinding finding = found.finding;
  finding.dataset = dataset.title;
  finding.sentence = report::verdict_sentence(finding);
  finding.model_before = sim::model_toml(given.model, given.notes);
  finding.model_after =
      is_better(finding) ? new_text(found, given.notes, source_of(dataset)) : finding.model_before;
  if (options.recheck && is_better(finding) && !finding.force_drive) add_recheck(finding, options, line);
  finding.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return finding;
}

void accept(const GapFinding& finding, const fs::path& model) {
  if (is_better(finding)) {
    const fs::path old = accept_model(model, finding.model_after);
    fmt::print("accepted: {} is now the new model; the old one is kept as {}\n", model.string(),
               old.string());
  } else {
    fmt::print("nothing to accept: {} stays as it was\n", model.string());
  }
}

}  // namespace

int gap(const GapOptions& options) {
  const sim::NotedModel given = sim::read_noted_model(options.model);
  sim::Dataset dataset = sim::read_dataset(options.dataset, given.model.baseline.drive);
  dataset.title = title_of(dataset, options.dataset);
  refuse_unusable(dataset, given.model, options);
  if (options.accept) refuse_unless_replaceable(options.model);
  claim_run_folder(options.out, {options.dataset, options.model});
  const GapFinding finding = compared(options, dataset, given);
  report::save_gap(finding, options.out);
  fmt::print("{}", report::gap_console(finding));
  fmt::print("\nreport: {}\nmodel:  {}\n", (options.out / "report.html").string(),
             (options.out / "model.toml").string());
  if (options.accept) accept(finding, options.model);
  return 0;
}

}  // namespace biopsy::robot
