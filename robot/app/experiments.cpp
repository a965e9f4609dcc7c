#include "robot/app/experiments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/nominal_model.hpp"
#include "robot/messages/setup_error.hpp"

namespace biopsy::app {
namespace {

using control::VoltageProgram;
using control::VoltageSegment;
using planner::NominalModel;

constexpr std::uint32_t kRamp_ticks = 1'000;  // to the working voltage and back
constexpr std::uint32_t kRest_ticks = 500;    // at 0 V behind the last ramp
constexpr Millimetres kWorking{5.0};          // paper IV.E: where the impacts happened
// Of the 50 mm/s that R-15 takes for a lost drive, seven tenths: a healthy stage stays below, friction or
// not.
constexpr double kFastest_mm_s = 35.0;

std::uint32_t ticks_of(Seconds time) {
  return static_cast<std::uint32_t>(std::lround(time / kTick));
}

Volts drive_for(Millimetres depth, Grams weight) {
  const std::optional<Volts> drive = NominalModel(weight).drive(depth);
  if (!drive)
    throw SetupError(fmt::format("{:.0f} g cannot be lifted by {:.1f} mm", weight.value, depth.value),
                     "--weight-g", "put less on the fixture");
  return Volts(10.0 * std::round(drive->value / 10.0));
}

VoltageProgram hold_at(Volts amplitude, std::uint32_t stand_ticks) {
  return {.segments = {{kRamp_ticks, Volts(0), amplitude},
                       {stand_ticks, amplitude, amplitude},
                       {kRamp_ticks, amplitude, Volts(0)},
                       {kRest_ticks, Volts(0), Volts(0)}}};
}

std::string named(const std::string& what, Grams weight) {
  return fmt::format("{}-{:.0f}g", what, weight.value);
}

BenchRun dc_run(const std::string& name, const std::string& what, const VoltageProgram& shape, int sign,
                Grams weight) {
  VoltageProgram program = shape;
  program.half_period_ticks = 0;
  program.sign = sign;
  program.hold_from_tick = program.segments.front().ticks + 2;  // a hold lets nothing rise: first the top
  return {.name = named(name, weight),
          .what = fmt::format("{:+.2f} kV DC {}, in a hold of the supervisor",
                              sign * control::highest(program).value * 1e-3, what),
          .weight = weight,
          .program = program,
          .loads = {}};
}

// As steep as the gate allows, and too low to lift: nothing moves, and the current tells R, C1 and C2.
VoltageProgram electrical_step(Grams weight) {
  constexpr double kShareOfLift = 0.75;
  constexpr std::uint32_t kStep_ticks = 25, kStand_ticks = 8'000;
  const Volts amplitude = kShareOfLift * drive_for(Millimetres(0.01), weight);
  return {.segments = {{kStep_ticks, Volts(0), amplitude},
                       {kStand_ticks, amplitude, amplitude},
                       {kStep_ticks, amplitude, Volts(0)},
                       {kRest_ticks, Volts(0), Volts(0)}}};
}

// After T of DC the films hold a charge that lifts on its own once the voltage is gone, K (1 - exp(-T / tau))
// of it: after 8 s a stage a little stronger than nominal stays up, and R-02 locks. 4 s and a slow way down
// leave 0.45 K, which lifts nothing.
std::vector<BenchRun> dc_runs(Grams weight) {
  constexpr std::uint32_t kStand_ticks = 4'000, kDown_ticks = 4'000;
  VoltageProgram lifting = hold_at(drive_for(kWorking, weight), kStand_ticks);
  lifting.segments[2].ticks = kDown_ticks;
  return {dc_run("dc-step", "for 8 s, too low to lift", electrical_step(weight), 1, weight),
          dc_run("dc-plus", "for 4 s and down in 4 s", lifting, 1, weight),
          dc_run("dc-minus", "for 4 s and down in 4 s", lifting, -1, weight)};
}

// As high as the working voltage, but no higher than a change of polarity, which lets the films' voltage
// jump, can be followed without a swing.
Volts amplitude_for(Seconds half_period, Grams weight) {
  const NominalModel model(weight);
  const planner::FilmShare share = planner::film_share(half_period);
  const Volts most = drive_for(kWorking, weight), stride(10.0);
  const Millimetres largest_jump(kFastest_mm_s / model.speed_after_voltage());
  Volts amplitude(500.0);
  while (amplitude < most &&
         model.depth_on_films(share.start * amplitude) - model.depth_on_films(share.end * amplitude) <
             largest_jump)
    amplitude += stride;
  return amplitude;
}

std::vector<BenchRun> frequency_runs(Grams weight) {
  std::vector<BenchRun> runs;
  for (const double hertz : {10.0, 5.0, 2.0, 1.0, 0.5, 0.2}) {  // the gentlest first
    const Seconds half_period(0.5 / hertz);
    const Volts amplitude = amplitude_for(half_period, weight);
    const Seconds stand = std::max(Seconds(4.0), 6.0 * half_period);
    VoltageProgram program = hold_at(amplitude, ticks_of(stand));
    program.half_period_ticks = ticks_of(half_period);
    runs.push_back({.name = named(fmt::format("frequency-{:g}hz", hertz), weight),
                    .what = fmt::format("{:g} Hz square wave of {:.2f} kV for {:.0f} s", hertz,
                                        amplitude.value * 1e-3, stand.count()),
                    .weight = weight,
                    .program = program,
                    .loads = {}});
  }
  return runs;
}

BenchRun staircase_run(Grams weight) {
  constexpr std::uint32_t kStep_ticks = 600, kTread_ticks = 1'200;
  VoltageProgram program;
  Volts now;
  const auto step_to = [&](Volts next) {
    program.segments.push_back({kStep_ticks, now, next});
    program.segments.push_back({kTread_ticks, next, next});
    now = next;
  };
  for (const double depth : {1.5, 3.0, 4.5, 6.0, 7.5, 6.0, 4.5, 3.0, 1.5})
    step_to(drive_for(Millimetres(depth), weight));
  step_to(Volts(0));
  return {.name = named("staircase", weight),
          .what = fmt::format("2 Hz, five steps up to {:.2f} kV and down again",
                              control::highest(program).value * 1e-3),
          .weight = weight,
          .program = program,
          .loads = {}};
}

std::vector<BenchRun> staircase_runs(Grams weight) {
  constexpr Grams kMore{50.0};  // what depends on the load comes apart only where the load changes
  const Grams other = weight + kMore <= planner::kWeightMax ? weight + kMore : weight - kMore;
  return {staircase_run(weight), staircase_run(other)};
}

// The push after which plate A settles as much lower as it may jump.
double largest_push(Volts amplitude, Grams weight) {
  const NominalModel model(weight);
  const Millimetres lowest = model.depth(amplitude) - Millimetres(kFastest_mm_s / model.speed_after_push());
  double push_N = 0.0;
  while (model.depth(amplitude, push_N + 1e-3) > lowest) push_N += 1e-3;
  return push_N;
}

std::vector<BenchRun> load_runs(Grams weight) {
  constexpr std::uint32_t kStand_ticks = 1'500;
  const Volts amplitude = drive_for(kWorking, weight);
  const double push_N = largest_push(amplitude, weight);
  BenchRun run{
      .name = named("load", weight),
      .what = fmt::format("2 Hz, {:.2f} kV; a push of {:.3f} N is put on, doubled and taken off again",
                          amplitude.value * 1e-3, push_N),
      .weight = weight,
      .program = hold_at(amplitude, 6 * kStand_ticks),
      .loads = {}};
  std::uint32_t from = kRamp_ticks + kStand_ticks;
  for (const double times : {1.0, 2.0, 1.0}) {
    run.loads.push_back({from, from + kStand_ticks, times * push_N});
    from += kStand_ticks;
  }
  return {run};
}

std::vector<BenchRun> impact_runs(Grams weight) {
  constexpr std::uint32_t kApart_ticks = 2'000;
  const Volts amplitude = drive_for(kWorking, weight);
  // One that ends when plate A swings back adds a second swing to the first.
  const double push_N = 0.7 * largest_push(amplitude, weight);
  BenchRun run{.name = named("impact", weight),
               .what = fmt::format("2 Hz, {:.2f} kV; blows of {:.3f} N for 20, 75 and 500 ms",
                                   amplitude.value * 1e-3, push_N),
               .weight = weight,
               .program = hold_at(amplitude, 4 * kApart_ticks),
               .loads = {}};
  std::uint32_t from = kRamp_ticks + kApart_ticks;
  for (const std::uint32_t lasts : {20U, 75U, 500U}) {
    run.loads.push_back({from, from + lasts, push_N});
    from += kApart_ticks;
  }
  return {run};
}

std::string list_of_names() {
  std::string list;
  for (const Experiment& experiment : experiments())
    list += (list.empty() ? "" : ", ") + std::string(experiment.name);
  return list;
}

}  // namespace

const std::vector<Experiment>& experiments() {
  // The first run that is stopped ends them all: what asks most of an unknown stage comes last.
  static const std::vector<Experiment> list{
      {"dc", "one polarity held: how far the displacement falls (paper, Fig. 6)", dc_runs},
      {"staircase", "up and down in steps, with two weights: hysteresis (Fig. 8b)", staircase_runs},
      {"load", "a push on the plate, in steps: stiffness", load_runs},
      {"impact", "short blows on the plate: damping (Fig. 11)", impact_runs},
      {"frequency", "square waves of 10 to 0.2 Hz: level and oscillation (Fig. 7)", frequency_runs}};
  return list;
}

std::vector<BenchRun> runs_of(const std::vector<std::string>& names, Grams weight) {
  if (!(weight >= Grams(0) && weight <= planner::kWeightMax))
    throw SetupError(
        fmt::format("a weight of {:g} g is outside 0 to {:.0f} g", weight.value, planner::kWeightMax.value),
        "--weight-g", "put less on the fixture");
  for (const std::string& name : names)
    if (std::none_of(experiments().begin(), experiments().end(),
                     [&](const auto& e) { return e.name == name; }))
      throw SetupError(fmt::format("there is no experiment \"{}\"", name), "command line",
                       "choose from: " + list_of_names() + "; or name none for all of them");
  std::vector<BenchRun> runs;
  for (const Experiment& experiment : experiments())
    if (names.empty() || std::find(names.begin(), names.end(), experiment.name) != names.end())
      for (BenchRun& run : experiment.runs(weight)) runs.push_back(std::move(run));
  return runs;
}

planner::BenchRequest bench_request(const BenchRun& run) {
  planner::BenchRequest request{
      .what = run.what, .weight = run.weight, .highest = control::highest(run.program)};
  if (run.program.half_period_ticks > 0)
    request.half_period = static_cast<double>(run.program.half_period_ticks) * Seconds(kTick);
  return request;
}

double push_at(const BenchRun& run, std::uint32_t tick) {
  double push_N = 0.0;
  for (const LoadStep& load : run.loads)
    if (tick >= load.from_tick && tick < load.to_tick) push_N += load.push_N;
  return push_N;
}

}  // namespace biopsy::app
