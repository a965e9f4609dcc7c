#include "tests/verification/nuisance/healthy_procedures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "robot/common/in_parallel.hpp"
#include "safety/types/transitions.hpp"
#include "tests/verification/fault_injection/procedure.hpp"
#include "tests/verification/nuisance/varied_operator.hpp"

namespace biopsy::fault_injection {
namespace {

constexpr std::int64_t kTicksMax = 300'000;  // five minutes: slower than any operator
constexpr std::size_t kBlock = 32;           // procedures at once
constexpr std::uint64_t kDays = 0x6461'7973, kOperators = 0x7065'6f70;

// A layer gave way and the needle is truly well beyond the end of its stage, by more than half of what the
// supervisor allows there: that hold has its reason.
bool has_jumped(const TickRecord& line, const Plan& plan) {
  constexpr double kHalfOvershoot_mm = 0.25;
  return line.hazards == bit(safety::Hazard::StepDepth) &&
         line.depth_mm > plan.steps[line.step].depth.value + kHalfOvershoot_mm;
}

// Guide and tissue truly hold the needle out at 0 V: somebody has to withdraw it.
bool is_held(const TickRecord& line) {
  return line.hazards == bit(safety::Hazard::NeedleNotBack) && line.depth_mm > 0.95;
}

// What the stage truly did of late: an alarm that finds nothing but that has its reason.
class RecentMotion {
 public:
  void add(const TickRecord& line) {
    squares_kV2_[next_] = line.output_kV * line.output_kV;
    depths_mm_[next_] = line.depth_mm;
    next_ = (next_ + 1) % kTicks;
  }

  // Since the least voltage of these seconds the needle moved by less than a tenth of what the stage lifts
  // for as much of V^2 outside tissue, 8.1 mm at 8 kV (the paper's Fig. 8b): it is stuck.
  bool is_stuck() const {
    constexpr double kFreeStroke_mm_per_kV2 = 8.1 / 64.0, kLeastRise_kV2 = 10.0;
    const std::size_t last = (next_ + kTicks - 1) % kTicks;
    const auto least =
        static_cast<std::size_t>(std::ranges::min_element(squares_kV2_) - squares_kV2_.begin());
    const double rise_kV2 = squares_kV2_[last] - squares_kV2_[least];
    return rise_kV2 > kLeastRise_kV2 &&
           depths_mm_[last] - depths_mm_[least] < 0.1 * kFreeStroke_mm_per_kV2 * rise_kV2;
  }

 private:
  static constexpr std::size_t kTicks = 4'000;
  std::array<double, kTicks> squares_kV2_{}, depths_mm_{};
  std::size_t next_ = 0;
};

bool is_unasked(const TickRecord& line, Mode before) {
  return line.mode != before && line.hazards != 0 && before != Mode::Boot;
}

// One procedure, as a run of one.
HealthyRun run_procedure(const NominalModels& models, std::uint64_t seed, std::uint64_t number,
                         const std::function<void(safety::SupervisorInputs&)>& corrupt_inputs) {
  const Scenario scenario = draw_scenario(models, seed_of(seed, kDays, number));
  VariedOperator varied(scenario.plan, seed_of(seed, kOperators, number));
  Procedure procedure(scenario);
  Corruptors inputs;
  inputs.world = [&](robot::OperatorInputs& world) { world = varied.act(procedure.last()); };
  inputs.observation = corrupt_inputs;
  procedure.corrupt(std::move(inputs));
  HealthyRun run;
  RecentMotion motion;
  Mode before = Mode::Boot;
  std::int64_t ticks = 0;
  std::uint32_t step = 0;
  for (; ticks < kTicksMax && !varied.done(); ++ticks) {
    const TickRecord line = procedure.tick();
    step = std::max(step, line.step);
    motion.add(line);
    const bool fell = line.mode != before && (line.mode == Mode::Trip || line.mode == Mode::Lock);
    const bool unasked = is_unasked(line, before) && !fell;
    const bool stopped = unasked && !has_jumped(line, scenario.plan) && !is_held(line);
    const bool stuck = line.hazards == bit(safety::Hazard::SensorFrozen) && motion.is_stuck();
    run.needles_held += unasked && is_held(line);
    run.punctures_held += unasked && has_jumped(line, scenario.plan);
    run.trips += fell;
    run.unexpected_stops += stopped;
    run.borne_out += (fell || stopped) && (is_held(line) || stuck);
    if ((fell || stopped) && run.alarms.empty())
      run.alarms.push_back(
          {1, number, static_cast<double>(ticks) * 1e-3,
           fmt::format("{} to {}: {}; needle at {:.2f} mm of {:.2f}", safety::name_of(before),
                       safety::name_of(line.mode), safety::name_of(safety::worst_of(line.hazards)),
                       line.depth_mm, scenario.plan.steps[line.step].depth.value)});
    before = line.mode;
  }
  run.hours = static_cast<double>(ticks) / 3.6e6;
  run.procedures = 1;
  run.completed = varied.completed();
  run.given_up = varied.gave_up();
  run.steps = static_cast<std::int32_t>(step) + 1;
  run.releases = varied.releases();
  if (!varied.completed() && !varied.gave_up() && run.alarms.empty())
    run.alarms.push_back({1, number, static_cast<double>(ticks) * 1e-3, "did not reach its target"});
  return run;
}

}  // namespace

HealthyRun joined(HealthyRun a, const HealthyRun& b) {
  a.hours += b.hours;
  a.procedures += b.procedures;
  a.completed += b.completed;
  a.given_up += b.given_up;
  a.steps += b.steps;
  a.releases += b.releases;
  a.trips += b.trips;
  a.unexpected_stops += b.unexpected_stops;
  a.punctures_held += b.punctures_held;
  a.needles_held += b.needles_held;
  a.borne_out += b.borne_out;
  a.alarms.insert(a.alarms.end(), b.alarms.begin(), b.alarms.end());
  return a;
}

HealthyRun run_healthy_procedures(const NominalModels& models, double hours, std::uint64_t seed,
                                  const std::function<void(safety::SupervisorInputs&)>& corrupt_inputs,
                                  const std::function<void(double share)>& progress) {
  HealthyRun day;
  while (day.hours < hours) {
    std::vector<HealthyRun> block(kBlock);
    const auto first = static_cast<std::uint64_t>(day.procedures);
    in_parallel(kBlock,
                [&](std::size_t i) { block[i] = run_procedure(models, seed, first + i, corrupt_inputs); });
    day = std::accumulate(block.begin(), block.end(), std::move(day), joined);
    progress(day.hours / hours);
  }
  return day;
}

}  // namespace biopsy::fault_injection
