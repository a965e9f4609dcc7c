#include "robot/bench/characterise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include "robot/bench/bench_notes.hpp"
#include "robot/bench/bench_session.hpp"
#include "robot/bench/stage_runs.hpp"
#include "robot/bench/until_named.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/live/processes/commissioned_stage.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/live/session/live_options.hpp"
#include "robot/report/study/bench_report.hpp"
#include "robot/security/key_files.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

report::BenchRunRecord record_of(const BenchRun& run, const BenchResult& result) {
  report::BenchRunRecord record{.name = run.name,
                                .file = result.recorded.file,
                                .what = run.what,
                                .weight_g = run.setup.weight.value,
                                .stopped_because = result.stopped_because,
                                .stopped_s = result.stopped_s,
                                .expected_mm = planner::expected_travel(bench_request(run)).value,
                                .time_s = result.recorded.time,
                                .drive_kV = result.recorded.input,
                                .displacement_mm = result.recorded.displacement,
                                .push_N = result.recorded.external_force};
  for (double& volts : record.drive_kV) volts *= 1e-3;
  for (double& metres : record.displacement_mm) metres *= 1e3;
  return record;
}

// Standard deviation of the laser before the first voltage, over all runs, m.
double noise_at_rest(const std::vector<sim::RecordedRun>& runs) {
  double squares = 0.0;
  std::size_t count = 0;
  for (const sim::RecordedRun& run : runs) {
    std::size_t rest = 0;
    double mean = 0.0;
    while (rest < run.input.size() && run.input[rest] == 0.0) mean += run.displacement[rest++];
    mean /= static_cast<double>(std::max<std::size_t>(rest, 1));
    for (std::size_t i = 0; i < rest; ++i) squares += std::pow(run.displacement[i] - mean, 2);
    count += rest > 0 ? rest - 1 : 0;
  }
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0;
}

// The CSV first: a run that dataset.toml lists has its rows.
void store(const BenchResult& result, const sim::Dataset& dataset, const fs::path& folder) {
  std::string head;
  if (!result.stopped_because.empty())
    head = fmt::format("# incomplete: stopped at {:.3f} s, {}\n", result.stopped_s, result.stopped_because);
  for (const std::string& remark : result.remarks) head += "# " + remark + "\n";
  atomic_write(folder / result.recorded.file, head + sim::run_csv(result.recorded, sim::Drive::Stack));
  atomic_write(folder / "dataset.toml", sim::dataset_toml(dataset));
}

std::string title_of(const report::BenchRecord& record) {
  const std::string title = record.device == "simulated stage" ? "Simulated needle stage on the bench"
                                                               : "Needle stage on the bench";
  const std::size_t done = record.runs.size();
  if (done > 0 && !record.runs.back().stopped_because.empty())
    return title + fmt::format(" (incomplete: {} stopped, {})", record.runs.back().name,
                               record.runs.back().stopped_because);
  return done < record.planned_runs
             ? title + fmt::format(" (incomplete: {} of {} runs)", done, record.planned_runs)
             : title;
}

// The laboratory's stage and the supervisor's line to the interlock; both empty for the simulated stage.
struct Hardware {
  std::unique_ptr<drivers::HardwareNeedleStage> stage;
  std::unique_ptr<drivers::PulseOutput> supervisor_pulse;
};

Hardware open_hardware(const CharacteriseOptions& options) {
  if (drivers::is_simulated(options.device)) return {};
  const fs::path keys = options.keys.empty() ? security::default_folder() : options.keys;
  return {open_commissioned_stage(options.device, options.device_config, options.commissioning,
                                  security::signing_files(keys, security::Signer::Commissioning).public_key),
          drivers::make_supervisor_pulse(options.device, options.device_config)};
}

void add_run(report::BenchRecord& record, sim::Dataset& dataset, const BenchRun& run,
             const BenchResult& result, const fs::path& folder) {
  record.runs.push_back(record_of(run, result));
  note_the_beginning(record);
  for (const std::string& remark : result.remarks) record.notes.push_back(run.name + ": " + remark + ".");
  record.title = dataset.title = title_of(record);
  dataset.runs.push_back(result.recorded);
  dataset.sensor_noise = noise_at_rest(dataset.runs);
  record.sensor_noise_mm = *dataset.sensor_noise * 1e3;
  store(result, dataset, folder);
}

// Indices of the session's runs that are due after what is recorded; none: the session is over.
using Due = std::function<std::vector<std::size_t>(const sim::Dataset& recorded)>;

std::vector<std::size_t> all_at_once(const BenchSession& session, const sim::Dataset& recorded) {
  std::vector<std::size_t> out(recorded.runs.empty() ? session.runs.size() : 0);
  std::iota(out.begin(), out.end(), std::size_t{0});
  return out;
}

report::BenchRecord carry_out(const BenchSession& session, const CharacteriseOptions& options,
                              const Hardware& hardware, const Due& due, const std::stop_token& stop,
                              const std::function<void(const std::string&)>& notify) {
  ProgressLine line;
  report::BenchRecord record;
  record.simulated = hardware.stage == nullptr;
  record.device = record.simulated ? "simulated stage" : hardware.stage->product();
  if (record.simulated) record.model = session.model_file.string();
  record.notes = session.notes;
  sim::Dataset dataset;
  const auto carried_out = [&](std::size_t i) {  // whether it came to its end
    const BenchRun& run = session.runs[i];
    const RunHooks hooks{.show_progress =
                             [&](double share) {
                               line.show((static_cast<double>(record.runs.size()) + share) /
                                             static_cast<double>(record.planned_runs),
                                         run.name);
                             },
                         .stop = [&] { return stop.stop_requested(); },
                         .notify = notify};
    const BenchResult result = record.simulated
                                   ? run_simulated(session, i, options.seed, hooks)
                                   : run_on_hardware(session, i, 1 + options.seed, *hardware.stage,
                                                     *hardware.supervisor_pulse, hooks);
    if (result.recorded.time.empty()) {
      record.notes.push_back(
          fmt::format("{} was stopped before it began: {}.", run.name, result.stopped_because));
      return false;
    }
    add_run(record, dataset, run, result, options.out);
    return result.stopped_because.empty();
  };
  bool goes_on = true;
  while (goes_on) {
    const std::vector<std::size_t> runs = due(dataset);
    if (runs.empty()) break;
    record.planned_runs += runs.size();
    goes_on = std::ranges::all_of(runs, carried_out);
  }
  note_the_travel(record, session.highest(), options.drive_scale);
  atomic_write(options.out / "report.html", report::bench_html(record));
  return record;
}

}  // namespace

Characterisation characterise(const CharacteriseOptions& options, const std::vector<std::string>& clearable,
                              const std::stop_token& stop,
                              const std::function<void(const std::string&)>& notify) {
  const BenchSession session = prepare_session(options);
  if (options.dry_run)
    return {.record = {},
            .complete = true,
            .rounds = {},
            .text = describe_session(session) + "nothing was moved\n"};
  if (options.out.empty())
    throw ConfigError("nowhere to put the data set", "command line", "add --out FOLDER, or --dry-run");
  if (!options.bench)
    throw ConfigError("it is not confirmed that the stage is on the bench: no patient, no needle",
                      "command line",
                      "see what would be done with --dry-run; then clear the stage and add --bench");
  const Inputs inputs{session.model_file, options.device_config, options.commissioning, options.keys,
                      options.until_named};
  keep_apart(options.out, inputs, clearable);
  std::optional<UntilNamed> naming;
  if (!options.until_named.empty()) naming.emplace(session, options.until_named, stop);
  const Hardware hardware = open_hardware(options);
  claim_run_folder(options.out, inputs, clearable);
  if (hardware.stage) notify(realtime::to_text(realtime::become_realtime({.fifo_priority = kLoopPriority})));
  Characterisation out;
  const Due due = [&](const sim::Dataset& recorded) {
    return naming ? naming->next(recorded) : all_at_once(session, recorded);
  };
  out.record = carry_out(session, options, hardware, due, stop, notify);
  if (naming) out.rounds = naming->rounds();
  out.complete =
      out.record.runs.size() == out.record.planned_runs && out.record.runs.back().stopped_because.empty();
  out.text = fmt::format("{}\n{}data set: {}\nreport:   {}\n", report::bench_console(out.record),
                         to_text(out.rounds), options.out.string(), (options.out / "report.html").string());
  return out;
}

}  // namespace biopsy::robot
