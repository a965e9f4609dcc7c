#include "robot/bench/experiments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/plan/nominal_model.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::robot {
namespace {

using control::VoltageProgram;
using control::VoltageSegment;

constexpr std::uint32_t kRamp_ticks = 1'000;  // to the working voltage and back
constexpr std::uint32_t kRest_ticks = 500;    // at 0 V behind the last ramp
constexpr std::uint32_t kHand_ticks = 6'000;  // for a weight by hand: asked for, laid on within 3 s, settled
constexpr double kGram_N = 9.81e-3;
constexpr Millimetres kStillUp{0.5};  // least depth under a push
constexpr Millimetres kWorking{5.0};  // paper IV.E: depth of the impacts
// 70 % of the 50 mm/s at which R-15 reports a lost drive: a healthy stage stays below, with friction or
// without.
constexpr double kFastest_mm_s = 35.0;

std::uint32_t ticks_of(Seconds time) {
  return static_cast<std::uint32_t>(std::lround(time / kTick));
}

// The planner's nominal stage; voltages are scaled by drive_scale, pushes by push_scale.
class ScaledStage {
 public:
  explicit ScaledStage(const BenchSetup& setup)
      : nominal_(setup.weight),
        weight_(setup.weight),
        scale_(setup.drive_scale),
        push_scale_(setup.push_scale) {}

  Volts drive(Millimetres depth) const {
    const std::optional<Volts> drive = nominal_.drive(depth);
    if (!drive)
      throw ConfigError(fmt::format("{:.0f} g cannot be lifted by {:.1f} mm", weight_.value, depth.value),
                        "--weight-g", "put less on the fixture");
    return Volts(10.0 * std::round(scale_ * drive->value / 10.0));
  }
  Millimetres depth(Volts amplitude, double push_N = 0.0) const {
    return nominal_.depth(amplitude / scale_, push_N);
  }
  // How far the plate follows the jump of the films' voltage at a change of polarity.
  Millimetres jump(Volts amplitude, const planner::FilmShare& share) const {
    return nominal_.depth_on_films(share.start * amplitude / scale_) -
           nominal_.depth_on_films(share.end * amplitude / scale_);
  }
  Millimetres largest_jump() const { return Millimetres(kFastest_mm_s / nominal_.speed_after_voltage()); }
  // The push that lowers plate A by the largest allowed jump.
  double largest_push(Volts amplitude) const {
    const Millimetres lowest = depth(amplitude) - Millimetres(kFastest_mm_s / nominal_.speed_after_push());
    double push_N = 0.0;
    while (depth(amplitude, push_N + 1e-3) > lowest) push_N += 1e-3;
    return push_scale_ * push_N;
  }
  // A push that ends before the spring acts: its momentum may make plate A kFastest_mm_s fast.
  double largest_blow(Volts amplitude, Seconds lasts) const {
    const double momentum_N = nominal_.plate_a_kg() * kFastest_mm_s * 1e-3 / lasts.count();
    return std::max(push_scale_ * momentum_N, largest_push(amplitude));
  }

 private:
  planner::NominalModel nominal_;
  Grams weight_;
  double scale_, push_scale_;
};

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
                const BenchSetup& setup) {
  VoltageProgram program = shape;
  program.half_period_ticks = 0;
  program.sign = sign;
  program.hold_from_tick = program.segments.front().ticks + 2;  // the voltage cannot rise in a hold
  return {.name = named(name, setup.weight),
          .what = fmt::format("{:+.2f} kV DC {}, in a hold of the supervisor",
                              sign * control::highest(program).value * 1e-3, what),
          .setup = setup,
          .program = program,
          .loads = {}};
}

// As steep as the gate allows and too low to lift: the current alone identifies R, C1 and C2.
VoltageProgram electrical_step(const BenchSetup& setup) {
  constexpr double kShareOfLift = 0.75;
  constexpr std::uint32_t kStand_ticks = 8'000;
  const auto step_ticks = static_cast<std::uint32_t>(std::ceil(25.0 * setup.drive_scale));
  const Volts amplitude = kShareOfLift * ScaledStage(setup).drive(Millimetres(0.01));
  return {.segments = {{step_ticks, Volts(0), amplitude},
                       {kStand_ticks, amplitude, amplitude},
                       {step_ticks, amplitude, Volts(0)},
                       {kRest_ticks, Volts(0), Volts(0)}}};
}

// After a time T of DC the films retain the charge K (1 - exp(-T / tau)), which lifts without voltage: after
// 8 s a stage slightly stronger than nominal stays up, and R-02 refuses the next run. 4 s and a slow ramp
// down leave 0.45 K, which lifts nothing.
std::vector<BenchRun> dc_runs(const BenchSetup& setup) {
  constexpr std::uint32_t kStand_ticks = 4'000, kDown_ticks = 4'000;
  VoltageProgram lifting = hold_at(ScaledStage(setup).drive(kWorking), kStand_ticks);
  lifting.segments[2].ticks = kDown_ticks;
  return {dc_run("dc-step", "for 8 s, too low to lift", electrical_step(setup), 1, setup),
          dc_run("dc-plus", "for 4 s and down in 4 s", lifting, 1, setup),
          dc_run("dc-minus", "for 4 s and down in 4 s", lifting, -1, setup)};
}

// The working voltage, or less where the plate would swing at a change of polarity.
Volts amplitude_for(Seconds half_period, const BenchSetup& setup) {
  const ScaledStage stage(setup);
  const planner::FilmShare share = planner::film_share({}, half_period);
  const Volts most = stage.drive(kWorking), stride(10.0);
  const Millimetres largest_jump = stage.largest_jump();
  Volts amplitude(500.0);
  while (amplitude < most && stage.jump(amplitude, share) < largest_jump) amplitude += stride;
  return amplitude;
}

std::vector<BenchRun> frequency_runs(const BenchSetup& setup) {
  std::vector<BenchRun> runs;
  for (const double hertz : {10.0, 5.0, 2.0, 1.0, 0.5, 0.2}) {  // the least demanding first
    const Seconds half_period(0.5 / hertz);
    const Volts amplitude = amplitude_for(half_period, setup);
    const Seconds stand = std::max(Seconds(4.0), 6.0 * half_period);
    VoltageProgram program = hold_at(amplitude, ticks_of(stand));
    program.half_period_ticks = ticks_of(half_period);
    runs.push_back({.name = named(fmt::format("frequency-{:g}hz", hertz), setup.weight),
                    .what = fmt::format("{:g} Hz square wave of {:.2f} kV for {:.0f} s", hertz,
                                        amplitude.value * 1e-3, stand.count()),
                    .setup = setup,
                    .program = program,
                    .loads = {}});
  }
  return runs;
}

BenchRun staircase_run(const BenchSetup& setup) {
  constexpr std::uint32_t kStep_ticks = 600, kTread_ticks = 1'200;
  VoltageProgram program;
  Volts now;
  const auto step_to = [&](Volts next) {
    program.segments.push_back({kStep_ticks, now, next});
    program.segments.push_back({kTread_ticks, next, next});
    now = next;
  };
  for (const double depth : {1.5, 3.0, 4.5, 6.0, 7.5, 6.0, 4.5, 3.0, 1.5})
    step_to(ScaledStage(setup).drive(Millimetres(depth)));
  step_to(Volts(0));
  return {.name = named("staircase", setup.weight),
          .what = fmt::format("2 Hz, five steps up to {:.2f} kV and down again",
                              control::highest(program).value * 1e-3),
          .setup = setup,
          .program = program,
          .loads = {}};
}

std::vector<BenchRun> staircase_runs(const BenchSetup& setup) {
  constexpr Grams kMore{50.0};  // effects of the load are identifiable only where it changes
  BenchSetup other = setup;
  other.weight += setup.weight + kMore <= planner::kWeightMax ? kMore : -kMore;
  return {staircase_run(setup), staircase_run(other)};
}

// Weights are whole grams.
double pushed_with(const BenchSetup& setup, double push_N) {
  return setup.by_hand ? std::floor(grams_of(push_N)) * kGram_N : push_N;
}

std::string to_text(const BenchSetup& setup, double push_N) {
  return setup.by_hand ? fmt::format("{:.0f} g laid on by hand", grams_of(push_N))
                       : fmt::format("a push of {:.3f} N", push_N);
}

std::vector<BenchRun> load_runs(const BenchSetup& setup) {
  const std::uint32_t stand_ticks = setup.by_hand ? kHand_ticks : 1'500;
  const ScaledStage stage(setup);
  const Volts amplitude = stage.drive(kWorking);
  const double push_N = pushed_with(setup, stage.largest_push(amplitude));
  BenchRun run{.name = named("load", setup.weight),
               .what = fmt::format("2 Hz, {:.2f} kV; {}, doubled and taken off again", amplitude.value * 1e-3,
                                   to_text(setup, push_N)),
               .setup = setup,
               .program = hold_at(amplitude, 6 * stand_ticks),
               .loads = {}};
  std::uint32_t from = kRamp_ticks + stand_ticks;
  for (const double times : {1.0, 2.0, 1.0}) {
    run.loads.push_back({from, from + stand_ticks, times * push_N});
    from += stand_ticks;
  }
  if (stage.depth(amplitude, 2.0 * push_N) < kStillUp)
    throw ConfigError(fmt::format("a push of {:.3f} N, doubled, takes the nominal stage below {:g} mm",
                                  push_N, kStillUp.value),
                      "--push-scale", "take a smaller one");
  return {run};
}

std::vector<BenchRun> impact_runs(const BenchSetup& setup) {
  const ScaledStage stage(setup);
  const Volts amplitude = stage.drive(kWorking);
  // A blow that ends as plate A swings back excites it twice; by hand none is that short.
  const double share = setup.by_hand ? 1.0 : 0.7;
  const std::uint32_t apart_ticks = setup.by_hand ? 2 * kHand_ticks : 2'000;
  const std::vector<std::uint32_t> lasts =
      setup.by_hand ? std::vector<std::uint32_t>(3, kHand_ticks) : std::vector<std::uint32_t>{5, 75, 500};
  BenchRun run{.name = named("impact", setup.weight),
               .what = {},
               .setup = setup,
               .program = hold_at(amplitude, 4 * apart_ticks),
               .loads = {}};
  std::uint32_t from = kRamp_ticks + apart_ticks;
  std::string pushes;
  for (const std::uint32_t ticks : lasts) {
    const double push_N = pushed_with(setup, share * stage.largest_blow(amplitude, ticks * Seconds(kTick)));
    run.loads.push_back({from, from + ticks, push_N});
    pushes += fmt::format("{}{:.3f} N for {} ms", pushes.empty() ? "" : ", ", push_N, ticks);
    from += apart_ticks;
  }
  run.what = fmt::format(
      "2 Hz, {:.2f} kV; {}", amplitude.value * 1e-3,
      setup.by_hand ? to_text(setup, run.loads.front().push_N) + ", three times on and off" : pushes);
  return {run};
}

void check_range(double value, double low, double high, const char* what, const char* option,
                 const char* remedy) {
  if (!(value >= low && value <= high))
    throw ConfigError(fmt::format("{:g} {} is outside {:g} to {:g}", value, what, low, high), option, remedy);
}

std::string list_of_names() {
  std::string list;
  for (const Experiment& experiment : experiments())
    list += (list.empty() ? "" : ", ") + std::string(experiment.name);
  return list;
}

}  // namespace

const std::vector<Experiment>& experiments() {
  // The first run that is stopped ends the session: the most demanding experiment is last.
  static const std::vector<Experiment> list{
      {"dc", "one polarity held: how far the displacement falls (paper, Fig. 6)", dc_runs},
      {"staircase", "up and down in steps, with two weights: hysteresis (Fig. 8b)", staircase_runs},
      {"load", "a push on the plate, in steps: stiffness", load_runs},
      {"impact", "short blows on the plate: damping (Fig. 11)", impact_runs},
      {"frequency", "square waves of 10 to 0.2 Hz: level and oscillation (Fig. 7)", frequency_runs}};
  return list;
}

std::vector<BenchRun> runs_of(const std::vector<std::string>& names, const BenchSetup& setup) {
  check_range(setup.weight.value, 0.0, planner::kWeightMax.value, "g on the fixture", "--weight-g",
              "put less on the fixture");
  check_range(setup.drive_scale, 1.0, planner::kDriveScaleMax, "times the nominal voltage", "--drive-scale",
              "measure with 1 first; the report shows how far the stage went");
  check_range(setup.push_scale, 1.0, kPushScaleMax, "times the nominal push", "--push-scale",
              "measure with 1 first; the report shows whether the depth followed it");
  for (const std::string& name : names)
    if (std::none_of(experiments().begin(), experiments().end(),
                     [&](const auto& e) { return e.name == name; }))
      throw ConfigError(fmt::format("there is no experiment \"{}\"", name), "command line",
                        "choose from: " + list_of_names() + "; or name none for all of them");
  std::vector<BenchRun> runs;
  for (const Experiment& experiment : experiments())
    if (names.empty() || std::find(names.begin(), names.end(), experiment.name) != names.end())
      for (BenchRun& run : experiment.runs(setup)) runs.push_back(std::move(run));
  return runs;
}

planner::BenchRequest bench_request(const BenchRun& run) {
  planner::BenchRequest request{.what = run.what,
                                .weight = run.setup.weight,
                                .highest = control::highest(run.program),
                                .drive_scale = run.setup.drive_scale};
  if (run.program.half_period_ticks > 0)
    request.half_period = static_cast<double>(run.program.half_period_ticks) * Seconds(kTick);
  return request;
}

double grams_of(double push_N) {
  return push_N / kGram_N;
}

double push_at(const BenchRun& run, std::uint32_t tick) {
  double push_N = 0.0;
  for (const LoadStep& load : run.loads)
    if (tick >= load.from_tick && tick < load.to_tick) push_N += load.push_N;
  return push_N;
}

}  // namespace biopsy::robot
