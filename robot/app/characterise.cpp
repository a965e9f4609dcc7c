// biopsy characterise: the paper's open-loop experiments on a stage, under the supervisor, stored as a data
// set.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <variant>

#include "drivers/nidaqmx/pulse_line.hpp"
#include "robot/app/bench_run.hpp"
#include "robot/app/case.hpp"
#include "robot/app/commands.hpp"
#include "robot/app/experiments.hpp"
#include "robot/app/hand_push.hpp"
#include "robot/app/hardware_stage.hpp"
#include "robot/app/live_options.hpp"
#include "robot/app/progress.hpp"
#include "robot/app/run_folder.hpp"
#include "robot/keys/key_files.hpp"
#include "robot/messages/setup_error.hpp"
#include "robot/realtime/become_realtime.hpp"
#include "robot/realtime/stop_signals.hpp"
#include "robot/report/bench_report.hpp"
#include "robot/report/whole_file.hpp"
#include "sim/devices/sim_stage.hpp"
#include "sim/model_file.hpp"

namespace biopsy::app {
namespace {

namespace fs = std::filesystem;

constexpr double kRest_taus = 7.0;    // leaves a thousandth of the films' charge
constexpr double kMoved_mm = 1.0;     // a run that expects less does not lift
constexpr double kAtRest_mm = 0.2;    // between two runs' beginnings: ten times the laser's noise
constexpr double kLentNoise = 10e-6;  // m, laser of the 10 um class; without noise R-19 takes it for frozen

struct Session {
  fs::path model_file;
  sim::PlantModel model;
  std::vector<BenchRun> runs;
  std::vector<Plan> plans;  // one a run
  std::vector<std::string> notes;
};

bool is_real(const CharacteriseOptions& options) {
  return options.device == "nidaqmx";
}

Session prepared(const CharacteriseOptions& options) {
  if (!is_real(options) && options.device != "sim")
    throw SetupError(fmt::format("there is no device \"{}\"", options.device), "--device",
                     "there are sim and nidaqmx");
  if (is_real(options) && (options.device_config.empty() || options.commissioning.empty()))
    throw SetupError("a real stage without --device-config or --commissioning", "command line",
                     "give both; `biopsy commission` makes the record");
  Session session;
  session.model_file = options.model.empty() ? blank_case().rehearsal.model : options.model;
  session.model = sim::read_model(session.model_file);
  if (session.model.baseline.drive != sim::Drive::Stack)
    throw SetupError("the model is driven by a force and has no voltage", session.model_file.string(),
                     "give a model of the stage with its stack");
  auto& noise = session.model.effects.sensor_noise;
  if (!noise || !(noise->std > 0.0)) {
    noise = sim::SensorNoise{.std = kLentNoise};
    session.notes.push_back(
        "The model has no noise of the laser; it was lent 0.010 mm, because a depth that never changes looks "
        "like a broken sensor (R-19).");
  }
  session.runs = runs_of(options.experiments, {.weight = Grams(options.weight_g),
                                               .drive_scale = options.drive_scale,
                                               .push_scale = options.push_scale,
                                               .by_hand = is_real(options)});
  for (const BenchRun& run : session.runs) {
    auto plan = planner::plan_bench(bench_request(run));
    if (const auto* refusal = std::get_if<PlanRefusal>(&plan))
      throw SetupError(run.name + " is refused: " + refusal->what, "--weight-g, --drive-scale",
                       refusal->remedy);
    session.plans.push_back(std::get<Plan>(std::move(plan)));
  }
  return session;
}

// What will happen, before it happens.
void print_intention(const Session& session) {
  fmt::print("{:<24} {:>8} {:>7} {:>9} {:>12}  {}\n", "run", "weight g", "time s", "drive kV", "expected mm",
             "what");
  double seconds = 0.0, travel = 0.0;
  for (const BenchRun& run : session.runs) {
    const planner::BenchRequest request = bench_request(run);
    const double lasts = control::length_ticks(run.program) * Seconds(kTick).count();
    const double expected = planner::expected_travel(request).value;
    seconds += lasts, travel = std::max(travel, expected);
    fmt::print("{:<24} {:>8.0f} {:>7.1f} {:>9.2f} {:>12.1f}  {}\n", run.name, run.setup.weight.value, lasts,
               request.highest.value * 1e-3, expected, run.what);
  }
  fmt::print(
      "\n{} runs, {:.0f} s under voltage, largest expected travel {:.1f} mm; the supervisor ends a run "
      "beyond {:.1f} mm\n",
      session.runs.size(), seconds, travel, session.plans.front().limits.depth_max.value);
}

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

// The laser's scatter before the first voltage, over all runs. m
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

// The CSV first: whoever finds a run in dataset.toml finds its rows.
void store(const BenchResult& result, const sim::Dataset& dataset, const fs::path& folder) {
  std::string head;
  if (!result.stopped_because.empty())
    head = fmt::format("# incomplete: stopped at {:.3f} s, {}\n", result.stopped_s, result.stopped_because);
  report::write_whole_file(folder / result.recorded.file,
                           head + sim::run_csv(result.recorded, sim::Drive::Stack));
  report::write_whole_file(folder / "dataset.toml", sim::dataset_toml(dataset));
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

// One run on a new simulated stage: at rest, discharged, its films recovered.
BenchResult run_simulated(const Session& session, std::size_t i, const CharacteriseOptions& options,
                          const std::function<void(double)>& show, realtime::StopSignals& signals) {
  const BenchRun& run = session.runs[i];
  sim::PlantModel model = session.model;
  model.weight = run.setup.weight.value * 1e-3;
  sim::SimStage stage(model, options.seed + i);
  return run_on_bench(run, session.plans[i], 1 + options.seed,
                      {.stage = stage,
                       .push = [&](double force_N) { stage.push(force_N); },
                       .played = show,
                       .stop = [&] { return signals.came(); }});
}

// What to have at hand before the arm key is turned; empty where no weight is laid on in the run.
std::string to_have_ready(const BenchRun& run) {
  if (run.loads.empty()) return {};
  const auto [least, most] = std::ranges::minmax(run.loads, {}, &LoadStep::push_N);
  return fmt::format(
      "have {:.0f} x {:.0f} g ready on a thread or an insulating rod (laid on under voltage), ",
      most.push_N / least.push_N, grams_of(least.push_N));
}

// What a reader has to know of weights laid on by hand.
std::string told(const std::string& name, const std::vector<HandPush>& pushes) {
  std::string unseen;
  for (const HandPush& push : pushes)
    if (!push.seen) unseen += fmt::format("{}{:.2f}", unseen.empty() ? "" : ", ", push.asked_s);
  return fmt::format(
      "{}: weights were laid on by hand; each push begins where the depth first follows, to about "
      "10 ms, and the mass that came with it is not in the data.{}",
      name, unseen.empty() ? "" : " Not seen in the depth, so dated as asked for: " + unseen + " s.");
}

// One run on the laboratory's stage, which is the same for all runs: the films' charge leaks away first. Then
// somebody puts the weight on and turns the arm key.
BenchResult run_on_hardware(const Session& session, std::size_t i, nidaqmx::NidaqmxStage& hardware,
                            const CharacteriseOptions& options, const std::function<void(double)>& show,
                            realtime::StopSignals& signals, std::vector<std::string>& notes) {
  const BenchRun& run = session.runs[i];
  const Seconds rest(i == 0 ? 0.0 : kRest_taus * session.model.baseline.tau);
  if (rest > Seconds(0.0))
    fmt::print("{}: at 0 V for {:.0f} s, until the films are discharged\n", run.name, rest.count());
  const auto ask = [&] {
    fmt::print("{}: put {:.0f} g on the fixture, {}clear the stage, then turn the arm key\n", run.name,
               run.setup.weight.value, to_have_ready(run));
    std::fflush(stdout);
  };
  const auto ask_for = [&, lies_N = 0.0](double push_N) mutable {
    if (push_N == lies_N) return;
    fmt::print("\n{}: NOW {} {:.0f} g\n", run.name, push_N > lies_N ? "lay on" : "lift off",
               grams_of(std::abs(push_N - lies_N)));
    std::fflush(stdout);
    lies_N = push_N;
  };
  PacedStage stage(hardware);
  nidaqmx::PulseLine supervisors_half(nidaqmx::read_config(options.device_config));
  const auto keys = [&] {
    const nidaqmx::Panel& panel = hardware.panel();
    return BenchKeys{panel.arm, panel.estop_a_closed && panel.estop_b_closed};
  };
  BenchResult result = run_on_bench(run, session.plans[i], 1 + options.seed,
                                    {.stage = stage,
                                     .push = ask_for,
                                     .played = show,
                                     .keys = keys,
                                     .supervisor_pulse = &supervisors_half,
                                     .rest = rest,
                                     .rested = ask,
                                     .stop = [&] { return signals.came(); }});
  if (run.loads.empty()) return result;
  const std::vector<HandPush> pushes =
      date_by_depth(result.recorded, 2 * static_cast<std::size_t>(run.program.half_period_ticks));
  if (!pushes.empty()) notes.push_back(told(run.name, pushes));
  return result;
}

std::unique_ptr<nidaqmx::NidaqmxStage> hardware_of(const CharacteriseOptions& options) {
  const fs::path keys = options.keys.empty() ? keys::default_folder() : options.keys;
  return commissioned_stage(options.device_config, options.commissioning,
                            keys::signing_files(keys, keys::Signer::Commissioning).public_key);
}

// Where plate A stood before the first voltage. mm
double began_at(const report::BenchRunRecord& run) {
  double sum = 0.0;
  std::size_t rest = 0;
  while (rest < run.drive_kV.size() && run.drive_kV[rest] == 0.0) sum += run.displacement_mm[rest++];
  return sum / static_cast<double>(std::max<std::size_t>(rest, 1));
}

// What a reader of the data has to know of the last run.
void add_note(report::BenchRecord& record) {
  const report::BenchRunRecord& run = record.runs.back();
  const double began = began_at(run), first = began_at(record.runs.front());
  if (std::abs(began - first) > kAtRest_mm)
    record.notes.push_back(
        fmt::format("{} began {:+.2f} mm from where {} began: something has stayed of what was done before.",
                    run.name, began - first, record.runs.front().name));
}

// What all of them tell of the stage that they were sized for.
void add_travel_notes(report::BenchRecord& record, double drive_scale) {
  constexpr double kLittle = 0.3, kMuch = 1.5;
  std::string little, much;
  for (const report::BenchRunRecord& run : record.runs) {
    if (!run.stopped_because.empty() || run.expected_mm < kMoved_mm) continue;
    const double travel =
        *std::max_element(run.displacement_mm.begin(), run.displacement_mm.end()) - began_at(run);
    if (travel < kLittle * run.expected_mm) little += (little.empty() ? "" : ", ") + run.name;
    if (travel > kMuch * run.expected_mm) much += (much.empty() ? "" : ", ") + run.name;
  }
  if (!little.empty())
    record.notes.push_back(
        fmt::format("Lifted less than a third of what was expected, and says little: {}. Friction has the "
                    "better of these "
                    "voltages, or the stack needs more; the next step would be --drive-scale {:g}.",
                    little, std::min(planner::kDriveScaleMax, drive_scale + 0.5)));
  if (!much.empty())
    record.notes.push_back(
        fmt::format("Lifted more than one and a half times what was expected: {}. Look at the weight on the "
                    "fixture{}.",
                    much, drive_scale > 1.0 ? ", and take a smaller --drive-scale" : ""));
}

// `hardware`: null for the simulated stage.
report::BenchRecord carried_out(const Session& session, const CharacteriseOptions& options,
                                nidaqmx::NidaqmxStage* hardware, realtime::StopSignals& signals) {
  ProgressLine line;
  report::BenchRecord record;
  record.device = hardware ? hardware->product() : "simulated stage";
  record.simulated = hardware == nullptr;
  if (record.simulated) record.model = session.model_file.string();
  record.notes = session.notes;
  record.planned_runs = session.runs.size();
  sim::Dataset dataset;
  for (std::size_t i = 0; i < session.runs.size(); ++i) {
    const BenchRun& run = session.runs[i];
    const auto show = [&](double share) {
      line.show((static_cast<double>(i) + share) / static_cast<double>(session.runs.size()), run.name);
    };
    const BenchResult result =
        hardware ? run_on_hardware(session, i, *hardware, options, show, signals, record.notes)
                 : run_simulated(session, i, options, show, signals);
    if (result.recorded.time.empty()) {
      record.notes.push_back(
          fmt::format("{} was stopped before it began: {}.", run.name, result.stopped_because));
      break;
    }
    record.runs.push_back(record_of(run, result));
    add_note(record);
    record.title = dataset.title = title_of(record);
    dataset.runs.push_back(result.recorded);
    dataset.sensor_noise = noise_at_rest(dataset.runs);
    record.sensor_noise_mm = *dataset.sensor_noise * 1e3;
    store(result, dataset, options.out);
    if (!result.stopped_because.empty()) break;
  }
  add_travel_notes(record, options.drive_scale);
  report::write_whole_file(options.out / "report.html", report::bench_html(record));
  return record;
}

}  // namespace

int characterise(const CharacteriseOptions& options) {
  realtime::StopSignals signals;  // Ctrl-C withdraws, and what was recorded is stored
  const Session session = prepared(options);
  if (options.dry_run) {
    print_intention(session);
    for (const std::string& note : session.notes) fmt::print("{}\n", note);
    fmt::print("nothing was moved\n");
    return 0;
  }
  if (options.out.empty())
    throw SetupError("nowhere to put the data set", "command line", "add --out FOLDER, or --dry-run");
  if (!options.bench)
    throw SetupError("nobody has said that the stage is on the bench: no patient, no needle", "command line",
                     "look at what would be done with --dry-run; then clear the stage and add --bench");
  const Inputs inputs{session.model_file, options.device_config, options.commissioning, options.keys};
  keep_apart(options.out, inputs);
  const auto hardware = is_real(options) ? hardware_of(options) : nullptr;
  claim_run_folder(options.out, inputs);
  if (hardware)
    fmt::print("{}\n", realtime::to_text(realtime::become_realtime({.fifo_priority = kLoopPriority})));
  const report::BenchRecord record = carried_out(session, options, hardware.get(), signals);
  fmt::print("{}\ndata set: {}\nreport:   {}\n", report::bench_console(record), options.out.string(),
             (options.out / "report.html").string());
  const bool complete =
      record.runs.size() == record.planned_runs && record.runs.back().stopped_because.empty();
  return complete ? 0 : 3;
}

}  // namespace biopsy::app
