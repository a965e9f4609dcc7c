#include "robot/bench/bench_operator.hpp"

#include <fmt/format.h>

namespace biopsy::robot {
namespace {

constexpr std::int64_t kReadyMax_ticks = 5'000;  // a healthy robot is ready within seconds
constexpr std::int64_t kKeyMax_ticks = 120'000;  // to put the weight on and to turn the key
constexpr std::int64_t kHandsOff_ticks = 3'000;  // from the key to the first volt
constexpr std::int64_t kArming_ticks = 50;       // a key's contact is filtered

}  // namespace

OperatorInputs BenchOperator::act(const CycleRecord& seen, bool done, bool holds, bool key) {
  follow(seen, done, holds);
  ++waited_;
  rested_ = rested_ || (phase_ == Phase::Ready && waited_ >= script_.rest);
  key_was_open_ = key_was_open_ || (requests_key() && !key);
  OperatorInputs inputs = OperatorInputs::idle();
  inputs.bench_confirmed = true;
  inputs.arm = requests_key() && (!script_.by_hand || (key_was_open_ && key));
  inputs.press = {running() ? 1U : 0U, running()};
  inputs.finish = phase_ == Phase::Withdraw;
  return inputs;
}

void BenchOperator::interrupt() {
  if (phase_ == Phase::Withdraw || phase_ == Phase::Finished) return;
  stopped_because_ = "interrupted";
  enter(Phase::Withdraw);
}

void BenchOperator::note_reason(const CycleRecord& seen) {
  const safety::SupervisorOutput& s = seen.supervisor;
  const safety::Hazard hazard = phase_ == Phase::Ready ? s.worst : s.reason;
  const bool unnamed = hazard == safety::Hazard::None;
  stopped_because_ = fmt::format("{}: {}", safety::name_of(s.permit.mode),
                                 unnamed ? safety::name_of(s.event) : safety::name_of(hazard));
}

void BenchOperator::give_up(const CycleRecord& seen) {
  note_reason(seen);
  enter(Phase::Withdraw);
}

void BenchOperator::follow_arming(const CycleRecord& seen) {
  const Mode mode = seen.supervisor.permit.mode;
  if (mode == Mode::Armed) {
    if (!armed_ && script_.by_hand) waited_ = 0;
    armed_ = true;
    if (waited_ > (script_.by_hand ? kHandsOff_ticks : script_.act_after)) enter(Phase::Run);
  } else if (armed_ || waited_ > (script_.by_hand ? kKeyMax_ticks : kArming_ticks)) {
    const bool key_missed = script_.by_hand && !armed_ && mode == Mode::Ready;
    give_up(seen);
    if (key_missed) stopped_because_ = "the arm key was not turned";
  }
}

void BenchOperator::follow(const CycleRecord& seen, bool done, bool holds) {
  const Mode mode = seen.supervisor.permit.mode;
  const bool stopped = mode == Mode::Trip || mode == Mode::Lock;
  switch (phase_) {
    case Phase::Ready:
      if (mode == Mode::Ready && rested_ && waited_ > script_.act_after)
        enter(Phase::Arm);
      else if (stopped || waited_ > script_.rest + kReadyMax_ticks)
        give_up(seen);
      break;
    case Phase::Arm:
      follow_arming(seen);
      break;
    case Phase::Run:
      if (done)
        enter(Phase::Withdraw);
      else if (waited_ > 1 && mode != Mode::Active && !(mode == Mode::Hold && holds))
        give_up(seen);
      break;
    case Phase::Withdraw:
      if (stopped && stopped_because_.empty()) note_reason(seen);
      if ((stopped || mode == Mode::Safe || mode == Mode::Ready) && waited_ > script_.withdrawn_after)
        enter(Phase::Finished);
      break;
    case Phase::Finished:
      break;
  }
}

CycleRecord play_tick(ControlCycle& cycle, const control::VoltageProgram& program,
                      control::ProgramState& state, const OperatorInputs& inputs,
                      drivers::PulseOutput* supervisor_pulse) {
  const CycleRecord seen = cycle.run(
      inputs, Environment::healthy(), [&](const Measurement&, const safety::SupervisorOutput& decided) {
        const control::ProgramStep next = control::play(program, state, decided.permit, inputs.finish);
        state = next.state;
        return next.request;
      });
  if (supervisor_pulse != nullptr && seen.supervisor.interlock_pulse) supervisor_pulse->pulse();
  return seen;
}

}  // namespace biopsy::robot
