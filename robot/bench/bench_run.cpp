#include "robot/bench/bench_run.hpp"

#include <cmath>
#include <utility>

#include "planner/plan/seal.hpp"
#include "robot/bench/bench_operator.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/cycle/run_cycle.hpp"

namespace biopsy::robot {
namespace {

constexpr std::int64_t kProgressEvery_ticks = 500;

// Row k: measured at its time; then its voltage and its force act until the next row.
void record(sim::RecordedRun& rows, const CycleRecord& tick, double push_N) {
  rows.time.push_back(static_cast<double>(rows.time.size()) * rows.period);
  rows.input.push_back(tick.drive_mV * 1e-3);
  rows.displacement.push_back(tick.measurement.depth_um * 1e-6);
  rows.current.push_back(tick.measurement.current_nA * 1e-9);
  rows.external_force.push_back(push_N);
}

}  // namespace

BenchResult run_on_bench(const BenchRun& run, const Plan& plan, std::uint64_t config_tag,
                         const Bench& bench) {
  const safety::PlanFacts facts = robot::plan_facts(plan, config_tag);
  const std::uint64_t tag = planner::plan_tag(plan);
  ControlCycle cycle(plan, facts, bench.stage, {tag, tag});
  const std::uint32_t length = control::length_ticks(run.program);
  BenchResult result;
  result.recorded.name = run.name;
  result.recorded.file = "run-" + run.name + ".csv";
  result.recorded.weight = run.setup.weight.value * 1e-3;
  BenchOperator operator_(
      {.rest = std::llround(bench.rest / Seconds(kTick)), .by_hand = static_cast<bool>(bench.keys)});
  control::ProgramState state;
  CycleRecord seen;
  double push_N = 0.0;
  if (bench.keys) bench.stage.read();  // keys are those of the last reading: none before the first
  for (bool played = false, asked = false; !operator_.finished();) {
    if (bench.stop && bench.stop()) operator_.interrupt();
    const bool recorded = operator_.recorded();
    const BenchKeys keys = bench.keys ? bench.keys() : BenchKeys{.arm = false, .estop_closed = true};
    OperatorInputs inputs = operator_.act(seen, played, state.ticks >= run.program.hold_from_tick, keys.arm);
    inputs.estop_closed = keys.estop_closed;
    if (operator_.requests_key() && !std::exchange(asked, true) && bench.request_key) bench.request_key();
    if (operator_.running()) push_N = push_at(run, state.ticks);
    bench.push(push_N);
    seen = play_tick(cycle, run.program, state, inputs, bench.supervisor_pulse);
    played = played || control::is_played(run.program, state);
    if (recorded) record(result.recorded, seen, push_N);
    if (result.stopped_s == 0.0 && !operator_.stopped_because().empty() && !result.recorded.time.empty())
      result.stopped_s = result.recorded.time.back();
    if (cycle.ticks() % kProgressEvery_ticks == 0)
      bench.show_progress(state.ticks / static_cast<double>(length));
  }
  result.stopped_because = operator_.stopped_because();
  return result;
}

}  // namespace biopsy::robot
