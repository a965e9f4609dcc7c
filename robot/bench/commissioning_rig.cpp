#include "robot/bench/commissioning_rig.hpp"

#include <cassert>
#include <cstdlib>
#include <utility>
#include <variant>

#include "planner/plan/bench_plan.hpp"
#include "planner/plan/seal.hpp"
#include "robot/bench/bench_operator.hpp"
#include "robot/control/voltage_program.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/cycle/run_cycle.hpp"

namespace biopsy::robot {
namespace {

using commissioning::Drive;
using commissioning::Sample;

constexpr Volts kMost{500.0};  // lifts the stack by less than 0.1 mm
constexpr Grams kWeight{50.0};
constexpr std::uint64_t kConfigTag = 1;  // nothing can change within a step
constexpr std::uint32_t kLevelRamp_ticks = 100;
constexpr BenchScript kScript{.act_after = 50, .withdrawn_after = 300};
constexpr std::int64_t kPause_ns = 100'000'000;  // without a tick, while the operator answers: a new clock

Plan small_voltages() {
  auto plan = planner::plan_bench({.what = "commissioning", .weight = kWeight, .highest = kMost});
  assert(std::holds_alternative<Plan>(plan));  // a request of constants
  return std::get<Plan>(std::move(plan));
}

// Up, there, and down again; of one sign.
control::VoltageProgram program_of(std::int32_t level_mV, std::uint32_t ticks) {
  const Volts level = from_mV(std::abs(level_mV));
  control::VoltageProgram program;
  program.segments = {
      {kLevelRamp_ticks, Volts(0), level}, {ticks, level, level}, {kLevelRamp_ticks, level, Volts(0)}};
  program.half_period_ticks = 0;
  program.sign = level_mV < 0 ? -1 : 1;
  return program;
}

Sample sample_of(const Measurement& m) {
  Sample sample;
  sample.reading = {.time_us = m.time_us,
                    .depth_um = m.depth_um,
                    .laser_code = m.laser_code,
                    .laser_valid = m.laser_valid,
                    .depth_b_um = m.depth_b_um,
                    .laser_b_valid = m.laser_b_valid,
                    .monitor_mV = m.monitor_mV,
                    .current_nA = m.current_nA};
  sample.command_mV = m.command_mV;
  return sample;
}

}  // namespace

SupervisedRig::SupervisedRig(drivers::NeedleStage& stage, StageConnections connections)
    : stage_(stage),
      connections_(std::move(connections)),
      plan_(small_voltages()),
      facts_(robot::plan_facts(plan_, kConfigTag)) {}

Sample SupervisedRig::in_tick(const std::function<Sample()>& act) {
  realtime::Wake wake;
  if (connections_.real_time) {
    if (!clock_ || realtime::monotonic_ns() - ticked_ns_ > kPause_ns) clock_.emplace(kTick);
    wake = clock_->wait();
  }
  Sample sample = act();
  if (connections_.real_time) {
    ticked_ns_ = realtime::monotonic_ns();
    sample.late_us = wake.late_ns() / 1'000;
    sample.work_us = (ticked_ns_ - wake.woke_ns) / 1'000;
  }
  if (!connections_.estop) return sample;
  const StageConnections::Contacts contacts = connections_.estop();
  sample.has_contacts = true;
  sample.estop_a_closed = contacts.a_closed;
  sample.estop_b_closed = contacts.b_closed;
  return sample;
}

Sample SupervisedRig::rest() {
  return in_tick([this] {
    Sample sample;
    sample.reading = stage_.read();
    stage_.write(safety::GatedVoltage::off());
    return sample;
  });
}

Drive SupervisedRig::drive(std::int32_t level_mV, std::uint32_t ticks,
                           const std::function<bool(const Sample&)>& go_on) {
  const control::VoltageProgram program = program_of(level_mV, ticks);
  const std::uint64_t tag = planner::plan_tag(plan_);
  ControlCycle cycle(plan_, facts_, stage_, {tag, tag});
  control::ProgramState state;
  BenchOperator operator_(kScript);
  CycleRecord seen;
  Drive drive;
  bool wanted = true;
  Sample sample;
  while (!operator_.finished()) {
    OperatorInputs inputs = operator_.act(seen, !wanted || control::is_played(program, state), false, false);
    inputs.estop_closed = sample.estop_a_closed && sample.estop_b_closed;
    sample = in_tick([&] {
      seen = play_tick(cycle, program, state, inputs,
                       supervisor_feeds_ ? connections_.supervisor_pulse : nullptr);
      return sample_of(seen.measurement);
    });
    const bool reached = !drive.samples.empty() || sample.command_mV == level_mV;
    if (reached) drive.samples.push_back(sample);
    const bool there = reached && state.ticks < kLevelRamp_ticks + ticks;
    if (wanted && operator_.running() && there) wanted = go_on(sample);
  }
  drive.stopped_because = operator_.stopped_because();
  return drive;
}

void SupervisedRig::feed_interlock(bool feeding) {
  if (connections_.feed_interlock) connections_.feed_interlock(feeding);
}

}  // namespace biopsy::robot
