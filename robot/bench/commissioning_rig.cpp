#include "robot/bench/commissioning_rig.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cstdlib>
#include <utility>
#include <variant>

#include "planner/plan/bench_plan.hpp"
#include "planner/plan/seal.hpp"
#include "robot/control/voltage_program.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/cycle/run_cycle.hpp"

namespace biopsy::robot {
namespace {

using commissioning::Drive;
using commissioning::Sample;

constexpr Volts kMost{500.0};  // lifts the stack by less than a tenth of a millimetre
constexpr Grams kWeight{50.0};
constexpr std::uint64_t kConfigTag = 1;  // nothing can change within a step
constexpr std::uint32_t kLevelRamp_ticks = 100;
constexpr std::uint32_t kThink_ticks = 50;  // in a mode before the next one is asked for
constexpr std::uint32_t kReady_ticks = 5'000;
constexpr std::uint32_t kLevelRest_ticks = 300;  // behind the end of the voltage
constexpr std::int64_t kPause_ns = 100'000'000;  // somebody was asked something: the rhythm begins anew

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
  sample.reading = {m.time_us, m.depth_um, m.laser_code, m.laser_valid, m.monitor_mV, m.current_nA};
  sample.command_mV = m.command_mV;
  return sample;
}

// The operator of one drive, as a script.
class DriveScript {
 public:
  OperatorInputs act() {
    OperatorInputs inputs = OperatorInputs::idle();
    inputs.bench_confirmed = true;
    inputs.arm = phase_ == Phase::Arm;
    inputs.press = {phase_ == Phase::Run ? 1U : 0U, phase_ == Phase::Run};
    inputs.finish = phase_ == Phase::Withdraw;
    return inputs;
  }

  // `done`: the voltage is no longer wanted.
  void watch(const CycleRecord& seen, bool done) {
    const Mode mode = seen.supervisor.permit.mode;
    const bool stopped = mode == Mode::Trip || mode == Mode::Lock;
    ++waited_;
    switch (phase_) {
      case Phase::Ready:
        if (mode == Mode::Ready && waited_ > kThink_ticks) return go(Phase::Arm);
        if (stopped || waited_ > kReady_ticks) give_up(seen);
        return;
      case Phase::Arm:
        if (mode == Mode::Armed && waited_ > kThink_ticks) return go(Phase::Run);
        if (waited_ > 1 && mode != Mode::Armed) give_up(seen);
        return;
      case Phase::Run:
        if (done) return go(Phase::Withdraw);
        if (waited_ > 1 && mode != Mode::Active) give_up(seen);
        return;
      case Phase::Withdraw:
        if (!seen.supervisor.permit.hv_enable && waited_ > kLevelRest_ticks) go(Phase::Over);
        return;
      case Phase::Over:
        return;
    }
  }

  bool over() const { return phase_ == Phase::Over; }
  bool running() const { return phase_ == Phase::Run; }
  const std::string& stopped_because() const { return stopped_because_; }

 private:
  enum class Phase : std::uint8_t { Ready, Arm, Run, Withdraw, Over };

  void go(Phase phase) { phase_ = phase, waited_ = 0; }

  void give_up(const CycleRecord& seen) {
    const safety::SupervisorOutput& s = seen.supervisor;
    const safety::Hazard hazard = phase_ == Phase::Ready ? s.worst : s.reason;
    stopped_because_ = fmt::format("{}: {}", safety::name_of(s.permit.mode), safety::name_of(hazard));
    go(Phase::Withdraw);
  }

  Phase phase_ = Phase::Ready;
  std::uint32_t waited_ = 0;
  std::string stopped_because_;
};

}  // namespace

SupervisedRig::SupervisedRig(drivers::NeedleStage& stage, StageTrimmings trimmings)
    : stage_(stage),
      trimmings_(std::move(trimmings)),
      plan_(small_voltages()),
      facts_(robot::plan_facts(plan_, kConfigTag)) {}

Sample SupervisedRig::in_tick(const std::function<Sample()>& act) {
  realtime::Wake wake;
  if (trimmings_.real_time) {
    if (!clock_ || realtime::monotonic_ns() - ticked_ns_ > kPause_ns) clock_.emplace(kTick);
    wake = clock_->wait();
  }
  Sample sample = act();
  if (trimmings_.real_time) {
    ticked_ns_ = realtime::monotonic_ns();
    sample.late_us = wake.late_ns() / 1'000;
    sample.work_us = (ticked_ns_ - wake.woke_ns) / 1'000;
  }
  if (!trimmings_.estop) return sample;
  const StageTrimmings::Contacts contacts = trimmings_.estop();
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
  ControlCycle supervised(plan_, facts_, stage_, {tag, tag});
  control::ProgramState state;
  DriveScript script;
  Drive drive;
  bool wanted = true;
  Sample sample;
  while (!script.over()) {
    OperatorInputs inputs = script.act();
    inputs.estop_closed = sample.estop_a_closed && sample.estop_b_closed;
    sample = in_tick([&] {
      const CycleRecord seen = supervised.run(
          inputs, Environment::healthy(), [&](const Measurement&, const safety::SupervisorOutput& decided) {
            const control::ProgramStep next = control::play(program, state, decided.permit, inputs.finish);
            state = next.state;
            return next.request;
          });
      if (trimmings_.supervisor_pulse != nullptr && supervisor_feeds_ && seen.supervisor.interlock_pulse)
        trimmings_.supervisor_pulse->pulse();
      script.watch(seen, !wanted || control::is_played(program, state));
      return sample_of(seen.measurement);
    });
    const bool reached = !drive.samples.empty() || sample.command_mV == level_mV;
    if (reached) drive.samples.push_back(sample);
    const bool there = reached && state.ticks < kLevelRamp_ticks + ticks;
    if (wanted && script.running() && there) wanted = go_on(sample);
  }
  drive.stopped_because = script.stopped_because();
  return drive;
}

void SupervisedRig::feed_interlock(bool feeding) {
  if (trimmings_.feed_interlock) trimmings_.feed_interlock(feeding);
}

}  // namespace biopsy::robot
