// biopsy campaign: many rehearsals with faults, at once or in shards.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "planner/plan/seal.hpp"
#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/progress.hpp"
#include "robot/common/sha256.hpp"
#include "robot/common/text/encoding.hpp"
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
  bool accept_images = false;
  std::string shard;
  std::size_t merge = 0;  // shards; 0: none
};

void declare(CLI::App& app, Options& options) {
  add_procedure_options(app, options.procedure);
  add(app, "--faults FILE", options.faults,
      "the [faults](faults.md) of a file, all of them in each rehearsal",
      "every kind, in sizes from small to gross");
  add(app, "--runs N", options.runs, "rehearsals of each fault, with seeds from `--seed` up", "20")
      ->check(in_range(1, 100'000));
  app.add_flag(
      "--accept-images", options.accept_images,
      "render no confirmation image and take each for accepted: several times as fast, and harder, since "
      "no image catches a fault");
  CLI::Option* shard = add(
      app, "--shard I/N", options.shard,
      "rehearse the I-th of N parts only and keep it in `shards`, unless it is there already", "all of it");
  add(app, "--merge N", options.merge, "rehearse nothing: put the N parts in `shards` together", "not")
      ->check(in_range(1, kShardsMax))
      ->excludes(shard);
}

Case campaign_case(const Options& options) {
  Case given = case_of(options.procedure);
  given.rehearsal.accept_unseen = options.accept_images;
  return given;
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

// Results of a campaign, however it was run.
Result report_campaign(const CampaignRuns& campaign, const fs::path& out, bool interrupted) {
  const std::vector<EntryResult> results = entry_results(campaign);
  EntryResult all;
  for (const EntryResult& one : results) all.runs += one.runs, all.beyond += one.beyond;
  json document{{"target_mm", campaign.target_mm},
                {"beyond_most_mm", kBeyondMost_mm},
                {"images_accepted", campaign.images_accepted},
                {"runs", all.runs},
                {"beyond", all.beyond},
                {"beyond_upper95", all.beyond_upper95()},
                {"interrupted", interrupted},
                {"entries", json::array()}};
  for (const EntryResult& one : results) document["entries"].push_back(to_json(one));
  const std::string text = document.dump(1) + "\n";
  atomic_write(out / "campaign.json", text);
  return {
      .exit_code = all.beyond > 0 ? 3 : 0,
      .text = table_of(results) +
              fmt::format(
                  "\n{} of {} rehearsals beyond target + {:g} mm; share below {:.2g} % at 95 % confidence{}\n"
                  "numbers: {}\n",
                  all.beyond, all.runs, kBeyondMost_mm, 100.0 * all.beyond_upper95(),
                  campaign.images_accepted ? "; each image was accepted unseen" : "",
                  (out / "campaign.json").string()),
      .json = text};
}

// Of this program and of what its rehearsals depend on.
std::string identity_of(const Options& options, const PreparedCase& prepared) {
  const Rehearsal& rehearsal = prepared.given.rehearsal;
  std::string text = fmt::format("{} {} {} {} {} {}\n", planner::plan_tag(std::get<Plan>(prepared.plan)),
                                 prepared.given.seed, options.runs, prepared.given.weight.value,
                                 rehearsal.scan.count(), options.accept_images);
  for (const fs::path& file :
       {fs::path("/proc/self/exe"), rehearsal.model, rehearsal.tissues, options.faults})
    if (!file.empty()) text += hex(sha256(read_file(file)));
  return hex(sha256(text));
}

Result refused(const PlanRefusal& refusal) {
  return {
      .exit_code = 3, .text = fmt::format("no plan: {}; {}\n", refusal.what, refusal.remedy), .json = "null"};
}

std::vector<FaultEntry> fault_entries(const Options& options) {
  if (options.faults.empty()) return fault_grid();
  return {{options.faults.filename().string(), FaultBegin::Start, sim::read_faults(options.faults)}};
}

struct Rehearsals {
  CampaignRuns campaign;
  bool were_there = false;
};

// The shard of the campaign; `scratch` holds images while they are needed. A shard of the same campaign in
// `kept` is taken from there.
Rehearsals rehearse(const Options& options, const std::vector<FaultEntry>& entries,
                    const PreparedCase& prepared, const Shard& shard, const fs::path& scratch,
                    const fs::path& kept, const std::stop_token& stop) {
  const std::string identity = identity_of(options, prepared);
  if (!kept.empty() && fs::exists(kept)) {
    CampaignRuns earlier = read_shard(kept, shard);
    if (earlier.identity == identity) return {std::move(earlier), true};
  }
  ProgressLine line;
  Rehearsals out{run_campaign(
      prepared, entries, {.runs = options.runs, .seed = prepared.given.seed, .shard = shard, .stop = stop},
      scratch, [&line](double share, const std::string& what) { line.show(share, what); })};
  out.campaign.identity = identity;
  return out;
}

Result run_shard(const Options& options, const Context& context) {
  const Shard shard = parse_shard(options.shard);
  const fs::path folder = options.procedure.out / "shards", kept = shard_file(folder, shard);
  const fs::path work = folder / kept.stem();  // of this shard alone: others may run beside it
  const std::vector<FaultEntry> entries = fault_entries(options);  // before anything is written
  const PreparedCase prepared = prepare_run(campaign_case(options), work, context.clearable);
  if (const auto* refusal = std::get_if<PlanRefusal>(&prepared.plan)) return refused(*refusal);
  const Rehearsals done =
      rehearse(options, entries, prepared, shard, work / "runs", kept, context.interrupted);
  fs::remove_all(work);
  if (context.interrupted.stop_requested())
    return {.text = "interrupted: nothing is kept of this shard\n", .json = "null"};
  if (!done.were_there) write_shard(kept, done.campaign, shard);
  return {.text = fmt::format("shard {}/{} {}: {}\n", shard.index, shard.count,
                              done.were_there ? "was there already" : "done", kept.string()),
          .json = read_file(kept)};
}

Result run(const Options& options, const Context& context) {
  const fs::path& out = options.procedure.out;
  if (options.merge > 0) return report_campaign(merge_shards(out / "shards", options.merge), out, false);
  if (!options.shard.empty()) return run_shard(options, context);
  const std::vector<FaultEntry> entries = fault_entries(options);  // before anything is written
  const PreparedCase prepared = prepare_run(campaign_case(options), out, context.clearable);
  if (const auto* refusal = std::get_if<PlanRefusal>(&prepared.plan)) return refused(*refusal);
  const Rehearsals done = rehearse(options, entries, prepared, {}, out / "runs", {}, context.interrupted);
  fs::remove_all(out / "runs");
  return report_campaign(done.campaign, out, context.interrupted.stop_requested());
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
          "the fault after which time. Nothing real moves.\n\nWith `--shard` several processes share a "
          "campaign, on one machine or many: each rehearses its part, and `--merge` puts the parts "
          "together to what one process would have written, to the bit "
          "([Campaigns on many machines](../how-to/campaigns.md)).",
      .examples = {"biopsy campaign gap --faults docs/examples/faults.toml --runs 4 --out out/campaign"},
      .long_examples = {"biopsy campaign liver --runs 299 --out out/campaign",
                        "biopsy campaign liver --runs 299 --accept-images --out out/campaign",
                        "biopsy campaign liver --runs 299 --shard 3/64 --out out/campaign",
                        "biopsy campaign --merge 64 --out out/campaign"},
      .exit_codes =
          "0 where no run came further than 2 mm beyond the target, 3 where one did or there is no plan, 2 "
          "for unusable input, 130 where Ctrl-C ended it; what was run until then is written",
      .outputs =
          {{"campaign.json",
            "`target_mm`, `images_accepted` (each unseen), `runs`, `beyond`, `beyond_upper95` (Clopper and "
            "Pearson, one-sided), and for each "
            "of "
            "`entries`: `name`, `runs`, `began`, `completed`, `beyond`, `worst_beyond_target_mm` with its "
            "seed "
            "and beginning, `completed_off_mm` (largest distance of a completed run's last true depth from "
            "the "
            "target), `detected_by` (hazard: runs), `detected_ms_median`, `detected_ms_max`"},
           {"planning", "the planning image of a built-in case, as DICOM"},
           {"shards", "with `--shard`: `I-of-N.json`, each rehearsal of a part", true}},
      .replaces_earlier_run = true,
      .json = "the content of `campaign.json`",
      .interruptible = true,
      .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
