#include "robot/bench/bench_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <variant>

#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/text/number_text.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::robot {
namespace {

constexpr double kRest_taus = 7.0;       // leaves a thousandth of the films' charge
constexpr double kAddedNoise_m = 10e-6;  // laser of the 10 um class; without noise R-19 takes it for frozen

void check_options(const CharacteriseOptions& options, bool simulated) {
  if (options.weights_by_hand && simulated)
    throw ConfigError("weights cannot be laid by hand on a simulated stage", "--weights-by-hand",
                      "leave it out: load and impact are simulated; or give --device nidaqmx");
}

std::filesystem::path model_file_of(const CharacteriseOptions& options, bool simulated) {
  if (!options.model.empty()) return options.model;
  return data_folder() / (simulated ? "sim/models/rehearsal.toml" : "sim/models/calibrated.toml");
}

void add_missing_noise(BenchSession& session) {
  auto& noise = session.model.effects.sensor_noise;
  if (noise && noise->std > 0.0) return;
  noise = sim::SensorNoise{.std = kAddedNoise_m};
  session.notes.push_back(
      "The model has no laser noise; 0.010 mm were added, because a depth that never changes is taken for a "
      "broken sensor (R-19).");
}

void leave_out(BenchSession& session, const std::string& why,
               const std::function<bool(const BenchRun&)>& which) {
  std::string names;
  for (const BenchRun& run : session.runs)
    if (which(run)) names += (names.empty() ? "" : ", ") + run.name;
  if (names.empty()) return;
  std::erase_if(session.runs, which);
  session.notes.push_back(fmt::format("Left out, because {}: {}.", why, names));
  if (session.runs.empty())
    throw ConfigError("no run is left: " + why, "EXPERIMENT",
                      "ask for dc, staircase or frequency, or add --weights-by-hand");
}

void leave_out_on_hardware(BenchSession& session, const CharacteriseOptions& options) {
  session.notes.push_back(
      fmt::format("Before each run the stage stands at 0 V for {:.0f} s.", session.rest().count()));
  if (!options.weights_by_hand)
    leave_out(session, "weights must be laid on by hand under voltage (--weights-by-hand)",
              [](const BenchRun& run) { return !run.loads.empty(); });
  leave_out(session,
            fmt::format("the laser's zero was taken with {:.0f} g on the fixture, and another weight changes "
                        "the position at rest; measure it in a session of its own",
                        options.weight_g),
            [&](const BenchRun& run) { return run.setup.weight.value != options.weight_g; });
}

}  // namespace

Seconds BenchSession::rest() const {
  return Seconds(kRest_taus * model.baseline.tau);
}

Volts BenchSession::highest() const {
  Volts highest;
  for (const Plan& plan : plans) highest = std::max(highest, plan.limits.v_max);
  return highest;
}

BenchSession prepare_session(const CharacteriseOptions& options) {
  const bool simulated = drivers::is_simulated(options.device);
  check_options(options, simulated);
  BenchSession session;
  session.model_file = model_file_of(options, simulated);
  session.model = sim::read_model(session.model_file);
  if (session.model.baseline.drive != sim::Drive::Stack)
    throw ConfigError("the model is driven by a force and has no voltage", session.model_file.string(),
                      "give a model of the stage with its stack");
  if (simulated) add_missing_noise(session);
  session.runs = runs_of(options.experiments, {.weight = Grams(options.weight_g),
                                               .drive_scale = options.drive_scale,
                                               .push_scale = options.push_scale,
                                               .by_hand = !simulated});
  if (!simulated) leave_out_on_hardware(session, options);
  for (const BenchRun& run : session.runs) {
    auto plan = planner::plan_bench(bench_request(run));
    if (const auto* refusal = std::get_if<PlanRefusal>(&plan))
      throw ConfigError(run.name + " is refused: " + refusal->what, "--weight-g, --drive-scale",
                        refusal->remedy);
    session.plans.push_back(std::get<Plan>(std::move(plan)));
  }
  return session;
}

std::string describe_session(const BenchSession& session) {
  std::string text = fmt::format("{:<24} {:>8} {:>7} {:>9} {:>12}  {}\n", "run", "weight g", "time s",
                                 "drive kV", "expected mm", "what");
  double total_s = 0.0, travel_mm = 0.0;
  for (const BenchRun& run : session.runs) {
    const planner::BenchRequest request = bench_request(run);
    const double duration_s = control::length_ticks(run.program) * Seconds(kTick).count();
    const double expected_mm = planner::expected_travel(request).value;
    total_s += duration_s, travel_mm = std::max(travel_mm, expected_mm);
    text += fmt::format("{:<24} {:>8.0f} {:>7.1f} {:>9.2f} {:>12.1f}  {}\n", run.name, run.setup.weight.value,
                        duration_s, request.highest.value * 1e-3, expected_mm, run.what);
  }
  text += fmt::format(
      "\n{}, {:.0f} s under voltage, largest expected travel {:.1f} mm; the supervisor ends a run "
      "beyond {:.1f} mm\n",
      counted(session.runs.size(), "run"), total_s, travel_mm, session.plans.front().limits.depth_max.value);
  for (const std::string& note : session.notes) text += note + "\n";
  return text;
}

}  // namespace biopsy::robot
