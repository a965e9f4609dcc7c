// biopsy characterise: the paper's open-loop experiments on a stage, under the supervisor, stored as a data
// set.
#include "robot/bench/characterise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <variant>

#include "drivers/nidaqmx/pulse_line.hpp"
#include "robot/bench/bench_notes.hpp"
#include "robot/bench/bench_run.hpp"
#include "robot/bench/experiments.hpp"
#include "robot/bench/hand_push.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/number_text.hpp"
#include "robot/common/progress.hpp"
#include "robot/live/processes/hardware_stage.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/live/session/live_options.hpp"
#include "robot/procedure/case.hpp"
#include "robot/report/study/bench_report.hpp"
#include "robot/security/key_files.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/simulated_stage.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

constexpr double kRest_taus = 7.0;    // leaves a thousandth of the films' charge
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

// At 0 V before each run on a real stage.
Seconds rest_of(const Session& session) {
  return Seconds(kRest_taus * session.model.baseline.tau);
}

// Leaves runs out, which are told why.
void leave_out(Session& session, const std::string& why, const std::function<bool(const BenchRun&)>& which) {
  std::string names;
  for (const BenchRun& run : session.runs)
    if (which(run)) names += (names.empty() ? "" : ", ") + run.name;
  if (names.empty()) return;
  std::erase_if(session.runs, which);
  session.notes.push_back(fmt::format("Left out, because {}: {}.", why, names));
  if (session.runs.empty())
    throw ConfigError("nothing is left to do: " + why, "EXPERIMENT",
                      "ask for dc, staircase or frequency, or add --weights-by-hand");
}

// What a real stage does not do by itself.
void leave_out_on_hardware(Session& session, const CharacteriseOptions& options) {
  session.notes.push_back(
      fmt::format("Before each run the stage stands at 0 V for {:.0f} s.", rest_of(session).count()));
  if (!options.weights_by_hand)
    leave_out(session, "somebody must lay weights on under voltage (--weights-by-hand)",
              [](const BenchRun& run) { return !run.loads.empty(); });
  leave_out(session,
            fmt::format("the laser's zero was taken with {:.0f} g on the fixture, and another weight stands "
                        "elsewhere at rest; measure it in a session of its own",
                        options.weight_g),
            [&](const BenchRun& run) { return run.setup.weight.value != options.weight_g; });
}

Session prepared(const CharacteriseOptions& options) {
  if (options.weights_by_hand && !is_real(options))
    throw ConfigError("no hand reaches a simulated stage", "--weights-by-hand",
                      "leave it out: load and impact are simulated; or give --device nidaqmx");
  Session session;
  session.model_file = !options.model.empty() ? options.model
                       : is_real(options)     ? data_folder() / "sim/models/calibrated.toml"
                                              : blank_case().rehearsal.model;
  session.model = sim::read_model(session.model_file);
  if (session.model.baseline.drive != sim::Drive::Stack)
    throw ConfigError("the model is driven by a force and has no voltage", session.model_file.string(),
                      "give a model of the stage with its stack");
  auto& noise = session.model.effects.sensor_noise;
  if (!is_real(options) && (!noise || !(noise->std > 0.0))) {
    noise = sim::SensorNoise{.std = kLentNoise};
    session.notes.push_back(
        "The model has no noise of the laser; it was lent 0.010 mm, because a depth that never changes looks "
        "like a broken sensor (R-19).");
  }
  session.runs = runs_of(options.experiments, {.weight = Grams(options.weight_g),
                                               .drive_scale = options.drive_scale,
                                               .push_scale = options.push_scale,
                                               .by_hand = is_real(options)});
  if (is_real(options)) leave_out_on_hardware(session, options);
  for (const BenchRun& run : session.runs) {
    auto plan = planner::plan_bench(bench_request(run));
    if (const auto* refusal = std::get_if<PlanRefusal>(&plan))
      throw ConfigError(run.name + " is refused: " + refusal->what, "--weight-g, --drive-scale",
                        refusal->remedy);
    session.plans.push_back(std::get<Plan>(std::move(plan)));
  }
  return session;
}

std::string intention_text(const Session& session) {
  std::string text = fmt::format("{:<24} {:>8} {:>7} {:>9} {:>12}  {}\n", "run", "weight g", "time s",
                                 "drive kV", "expected mm", "what");
  double seconds = 0.0, travel = 0.0;
  for (const BenchRun& run : session.runs) {
    const planner::BenchRequest request = bench_request(run);
    const double lasts = control::length_ticks(run.program) * Seconds(kTick).count();
    const double expected = planner::expected_travel(request).value;
    seconds += lasts, travel = std::max(travel, expected);
    text += fmt::format("{:<24} {:>8.0f} {:>7.1f} {:>9.2f} {:>12.1f}  {}\n", run.name, run.setup.weight.value,
                        lasts, request.highest.value * 1e-3, expected, run.what);
  }
  text += fmt::format(
      "\n{}, {:.0f} s under voltage, largest expected travel {:.1f} mm; the supervisor ends a run "
      "beyond {:.1f} mm\n",
      counted(session.runs.size(), "run"), seconds, travel, session.plans.front().limits.depth_max.value);
  for (const std::string& note : session.notes) text += note + "\n";
  return text + "nothing was moved\n";
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

// One run on a new simulated stage: at rest, discharged, its films recovered.
BenchResult run_simulated(const Session& session, std::size_t i, const CharacteriseOptions& options,
                          const std::function<void(double)>& show, const std::stop_token& stop) {
  const BenchRun& run = session.runs[i];
  sim::PlantModel model = session.model;
  model.weight = run.setup.weight.value * 1e-3;
  sim::SimulatedStage stage(model, options.seed + i);
  return run_on_bench(run, session.plans[i], 1 + options.seed,
                      {.stage = stage,
                       .push = [&](double force_N) { stage.push(force_N); },
                       .played = show,
                       .stop = [&] { return stop.stop_requested(); }});
}

// Asked before the arm key is turned.
std::string asked_before(const BenchRun& run) {
  const std::string begin =
      fmt::format("{}: {:.0f} g and nothing else on the fixture; ", run.name, run.setup.weight.value);
  const std::string end = "hands off, then turn the arm key (off first, if it is on)";
  if (run.loads.empty()) return begin + end;
  const auto [least, most] = std::ranges::minmax(run.loads, {}, &LoadStep::push_N);
  return begin +
         fmt::format("{:.0f} x {:.0f} g ready on an insulating rod, to be laid on under voltage when asked; ",
                     most.push_N / least.push_N, grams_of(least.push_N)) +
         end;
}

// What a reader has to know of weights laid on by hand.
std::vector<std::string> remarks_on(const std::vector<HandPush>& pushes, const BenchResult& result) {
  std::vector<std::string> remarks{
      "weights were laid on by hand; each pushes from where the depth first follows, to some 50 ms, and the "
      "mass that came with it is not in the data"};
  for (const HandPush& push : pushes)
    if (!push.seen)
      remarks.push_back(
          fmt::format("the depth does not show the change to {:.0f} g that was asked for at "
                      "{:.2f} s: perhaps it never was, perhaps friction held",
                      grams_of(push.force_N), push.asked_s));
  if (const double left_N = result.recorded.external_force.back(); left_N > 0.0)
    remarks.push_back(fmt::format("{:.0f} g still lay on the plate when it was stopped", grams_of(left_N)));
  return remarks;
}

// One run on the laboratory's stage, which is the same for all runs: the films' charge leaks away first. Then
// somebody puts the weight on and turns the arm key.
BenchResult run_on_hardware(const Session& session, std::size_t i, nidaqmx::NidaqmxStage& hardware,
                            const CharacteriseOptions& options, const std::function<void(double)>& show,
                            const std::stop_token& stop, const std::function<void(const std::string&)>& say) {
  const BenchRun& run = session.runs[i];
  const Seconds rest = rest_of(session);
  say(
      fmt::format("{}: at 0 V for {:.0f} s, in which the model's films lose their charge; measure before you "
                  "touch",
                  run.name, rest.count()));
  const auto ask_for = [&, lies_N = 0.0](double push_N) mutable {
    if (push_N == lies_N) return;
    say(fmt::format("\n{}: NOW {} {:.0f} g, within 3 s", run.name, push_N > lies_N ? "lay on" : "lift off",
                    grams_of(std::abs(push_N - lies_N))));
    lies_N = push_N;
  };
  RealtimeNeedleStage stage(hardware);
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
                                     .ask_for_key = [&] { say(asked_before(run)); },
                                     .stop = [&] { return stop.stop_requested(); }});
  if (run.loads.empty() || result.recorded.time.empty()) return result;
  const std::size_t under_program =
      result.stopped_because.empty()
          ? result.recorded.time.size()
          : static_cast<std::size_t>(std::llround(result.stopped_s / result.recorded.period));
  const std::vector<HandPush> pushes = date_by_depth(
      result.recorded, 2 * static_cast<std::size_t>(run.program.half_period_ticks), under_program);
  result.remarks = remarks_on(pushes, result);
  return result;
}

std::unique_ptr<nidaqmx::NidaqmxStage> hardware_of(const CharacteriseOptions& options) {
  const fs::path keys = options.keys.empty() ? security::default_folder() : options.keys;
  return commissioned_stage(options.device_config, options.commissioning,
                            security::signing_files(keys, security::Signer::Commissioning).public_key);
}

Volts highest_of(const Session& session) {
  Volts highest;
  for (const Plan& plan : session.plans) highest = std::max(highest, plan.limits.v_max);
  return highest;
}

// `hardware`: null for the simulated stage.
report::BenchRecord carried_out(const Session& session, const CharacteriseOptions& options,
                                nidaqmx::NidaqmxStage* hardware, const std::stop_token& stop,
                                const std::function<void(const std::string&)>& notify) {
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
    const BenchResult result = hardware ? run_on_hardware(session, i, *hardware, options, show, stop, notify)
                                        : run_simulated(session, i, options, show, stop);
    if (result.recorded.time.empty()) {
      record.notes.push_back(
          fmt::format("{} was stopped before it began: {}.", run.name, result.stopped_because));
      break;
    }
    record.runs.push_back(record_of(run, result));
    note_the_beginning(record);
    for (const std::string& remark : result.remarks) record.notes.push_back(run.name + ": " + remark + ".");
    record.title = dataset.title = title_of(record);
    dataset.runs.push_back(result.recorded);
    dataset.sensor_noise = noise_at_rest(dataset.runs);
    record.sensor_noise_mm = *dataset.sensor_noise * 1e3;
    store(result, dataset, options.out);
    if (!result.stopped_because.empty()) break;
  }
  note_the_travel(record, highest_of(session), options.drive_scale);
  atomic_write(options.out / "report.html", report::bench_html(record));
  return record;
}

}  // namespace

Characterisation characterise(const CharacteriseOptions& options, const std::vector<std::string>& clearable,
                              const std::stop_token& stop,
                              const std::function<void(const std::string&)>& notify) {
  const Session session = prepared(options);
  if (options.dry_run) return {.record = {}, .complete = true, .text = intention_text(session)};
  if (options.out.empty())
    throw ConfigError("nowhere to put the data set", "command line", "add --out FOLDER, or --dry-run");
  if (!options.bench)
    throw ConfigError("not confirmed that the stage is on the bench: no patient, no needle", "command line",
                      "look at what would be done with --dry-run; then clear the stage and add --bench");
  const Inputs inputs{session.model_file, options.device_config, options.commissioning, options.keys};
  keep_apart(options.out, inputs, clearable);
  const auto hardware = is_real(options) ? hardware_of(options) : nullptr;
  claim_run_folder(options.out, inputs, clearable);
  if (hardware) notify(realtime::to_text(realtime::become_realtime({.fifo_priority = kLoopPriority})));
  Characterisation out;
  out.record = carried_out(session, options, hardware.get(), stop, notify);
  out.complete =
      out.record.runs.size() == out.record.planned_runs && out.record.runs.back().stopped_because.empty();
  out.text = fmt::format("{}\ndata set: {}\nreport:   {}\n", report::bench_console(out.record),
                         options.out.string(), (options.out / "report.html").string());
  return out;
}

}  // namespace biopsy::robot
