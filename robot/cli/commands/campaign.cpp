// biopsy campaign: many rehearsals with faults.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/progress.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/procedure/campaign/fault_campaign.hpp"
#include "robot/procedure/procedure.hpp"
#include "sim/faults/fault_file.hpp"

namespace biopsy::robot {
namespace campaign_cli {

namespace fs = std::filesystem;
using json = nlohmann::ordered_json;

struct Options {
  ProcedureOptions procedure;
  fs::path faults;
  int runs = 20;
};

void declare(CLI::App& app, Options& options) {
  add_procedure_options(app, options.procedure);
  add(app, "--faults FILE", options.faults,
      "the [faults](faults.md) of a file, all of them in each rehearsal",
      "every kind, in sizes from small to gross");
  add(app, "--runs N", options.runs, "rehearsals of each fault, with seeds from `--seed` up", "20")
      ->check(in_range(1, 100'000));
}

json null_or(double value) {
  return std::isfinite(value) ? json(value) : json(nullptr);
}

json to_json(const EntryResult& one) {
  return {{"name", one.name},
          {"runs", one.runs},
          {"began", one.began},
          {"completed", one.completed},
          {"beyond", one.beyond},
          {"beyond_upper95", one.beyond_upper95()},
          {"worst_beyond_target_mm", one.worst_mm},
          {"worst_seed", one.worst_seed},
          {"worst_from_depth_mm", one.worst_from_depth_mm},
          {"completed_off_mm", one.completed_off_mm},
          {"detected_by", one.detected_by},
          {"detected_ms_median", null_or(one.detected_ms_median)},
          {"detected_ms_max", null_or(one.detected_ms_max)}};
}

// The hazard's number alone where there is one: the table stays narrow.
std::string detectors_text(const EntryResult& one) {
  std::string text;
  for (const auto& [name, runs] : one.detected_by)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ",
                        name.starts_with("H-") ? name.substr(0, name.find(' ')) : name, runs);
  return text.empty() ? "none" : text;
}

std::string table_of(const std::vector<EntryResult>& results) {
  std::string text = fmt::format("{:<44} {:>5} {:>6} {:>9} {:>9} {:>8}  {}\n", "fault", "runs", "began",
                                 "completed", "worst mm", "after ms", "detected by");
  for (const EntryResult& one : results)
    text += fmt::format(
        "{:<44} {:>5} {:>6} {:>9} {:>9} {:>8}  {}{}\n", one.name, one.runs, one.began, one.completed,
        fixed(one.worst_mm, 2),
        std::isfinite(one.detected_ms_median) ? fixed(one.detected_ms_median, 0) : "-", detectors_text(one),
        one.beyond > 0 ? fmt::format("  BEYOND TARGET + 2 mm: {} of {}, seed {} from {} mm", one.beyond,
                                     one.runs, one.worst_seed, fixed(one.worst_from_depth_mm, 3))
                       : "");
  return text;
}

Result run(const Options& options, const Context& context) {
  const fs::path& out = options.procedure.out;
  const std::vector<FaultEntry> entries =
      options.faults.empty() ? fault_grid()
                             : std::vector<FaultEntry>{{options.faults.filename().string(), FaultBegin::Start,
                                                        sim::read_faults(options.faults)}};
  const PreparedCase prepared = prepare_run(case_of(options.procedure), out, context.clearable);
  if (const auto* refusal = std::get_if<PlanRefusal>(&prepared.plan))
    return {.exit_code = 3,
            .text = fmt::format("no plan: {}; {}\n", refusal->what, refusal->remedy),
            .json = "null"};
  std::vector<EntryResult> results;
  {
    ProgressLine line;
    results = run_campaign(
        prepared, entries, {.runs = options.runs, .seed = prepared.given.seed, .stop = context.interrupted},
        out / "runs", [&line](double share, const std::string& what) { line.show(share, what); });
  }
  fs::remove_all(out / "runs");
  int runs = 0, beyond = 0;
  for (const EntryResult& one : results) runs += one.runs, beyond += one.beyond;
  EntryResult all;
  all.runs = runs, all.beyond = beyond;
  json document{{"target_mm", std::get<Plan>(prepared.plan).target_depth.value},
                {"beyond_most_mm", kBeyondMost_mm},
                {"runs", runs},
                {"beyond", beyond},
                {"beyond_upper95", all.beyond_upper95()},
                {"interrupted", context.interrupted.stop_requested()},
                {"entries", json::array()}};
  for (const EntryResult& one : results) document["entries"].push_back(to_json(one));
  const std::string text = document.dump(1) + "\n";
  atomic_write(out / "campaign.json", text);
  return {
      .exit_code = beyond > 0 ? 3 : 0,
      .text =
          table_of(results) +
          fmt::format(
              "\n{} of {} rehearsals beyond target + {:g} mm; share below {:.2g} % at 95 % confidence\n"
              "numbers: {}\n",
              beyond, runs, kBeyondMost_mm, 100.0 * all.beyond_upper95(), (out / "campaign.json").string()),
      .json = text};
}

}  // namespace campaign_cli

Command campaign_command() {
  using namespace campaign_cli;
  return {
      .name = "campaign",
      .summary = "rehearse many times with faults, and see how far the needle gets",
      .description =
          "Rehearses a case with each fault many times, on all cores: the faults of a file, or without one "
          "every "
          "kind of fault of depth sensor, monitors and drive in sizes from harmless to gross. Each run has "
          "its own "
          "seed; a fault that is not said to begin at the start begins at a depth drawn for the run. A table "
          "says "
          "how deep the true tip came beyond the target, how many runs were completed, and which hazard "
          "noticed "
          "the fault after which time. Nothing real moves.",
      .examples = {"biopsy campaign gap --faults docs/examples/faults.toml --runs 4 --out out/campaign"},
      .long_examples = {"biopsy campaign liver --runs 299 --out out/campaign"},
      .exit_codes =
          "0 where no run came further than 2 mm beyond the target, 3 where one did or there is no plan, 2 "
          "for unusable input, 130 where Ctrl-C ended it; what was run until then is written",
      .outputs =
          {{"campaign.json",
            "`target_mm`, `runs`, `beyond`, `beyond_upper95` (Clopper and Pearson, one-sided), and for each "
            "of "
            "`entries`: `name`, `runs`, `began`, `completed`, `beyond`, `worst_beyond_target_mm` with its "
            "seed "
            "and beginning, `completed_off_mm` (largest distance of a completed run's true depth from the "
            "target), `detected_by` (hazard: runs), `detected_ms_median`, `detected_ms_max`"},
           {"planning", "the planning image of a built-in case, as DICOM"}},
      .replaces_earlier_run = true,
      .json = "the content of `campaign.json`",
      .interruptible = true,
      .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
