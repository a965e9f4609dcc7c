#include "robot/bench/bench_run.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "planner/plan/seal.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/cycle/run_cycle.hpp"

namespace biopsy::robot {
namespace {

constexpr std::int64_t kThink_ticks = 300;       // between two acts of a hand
constexpr std::int64_t kReadyMax_ticks = 5'000;  // a healthy robot is ready within seconds
constexpr std::int64_t kReturn_ticks = 1'500;    // gravity brings the stage back, and R-02 would be seen
constexpr std::int64_t kHand_ticks = 120'000;    // for somebody to put the weight on and turn the key
constexpr std::int64_t kHandsOff_ticks = 3'000;  // from the key to the first volt
constexpr std::int64_t kToldEvery_ticks = 500;

// The person at the bench, as a script.
class BenchOperator {
 public:
  // `by_hand`: the arm key is a real one. `rest_ticks`: at 0 V before anything is asked for.
  BenchOperator(bool by_hand, std::int64_t rest_ticks)
      : by_hand_(by_hand), rest_ticks_(rest_ticks), rested_(rest_ticks <= 0) {}

  // What the person does in this tick, having seen the last one. `holds`: the program asks for a hold; `key`:
  // how the real arm key stands.
  OperatorInputs act(const CycleRecord& seen, bool played, bool holds, bool key) {
    watch(seen, played, holds);
    ++waited_;
    rested_ = rested_ || (step_ == Step::WaitReady && waited_ >= rest_ticks_);
    key_was_open_ = key_was_open_ || (asks_for_key() && !key);
    OperatorInputs inputs = OperatorInputs::idle();
    inputs.bench_confirmed = true;
    inputs.arm = asks_for_key() && (!by_hand_ || (key_was_open_ && key));
    inputs.press = {step_ == Step::Run ? 1U : 0U, step_ == Step::Run};
    inputs.finish = step_ == Step::Withdraw;
    return inputs;
  }
  void stop() {
    if (step_ == Step::Withdraw || step_ == Step::Done) return;
    stopped_because_ = "interrupted";
    go(Step::Withdraw);
  }
  bool asks_for_key() const { return step_ == Step::Arm; }
  bool recorded() const { return by_hand_ ? armed_ : rested_; }  // never, where it was stopped before
  bool running() const { return step_ == Step::Run; }
  bool done() const { return step_ == Step::Done; }
  const std::string& stopped_because() const { return stopped_because_; }

 private:
  enum class Step : std::uint8_t { WaitReady, Arm, Run, Withdraw, Done };

  void go(Step step) { step_ = step, waited_ = 0; }

  void note(const CycleRecord& seen) {
    const safety::SupervisorOutput& s = seen.supervisor;
    const safety::Hazard hazard = step_ == Step::WaitReady ? s.worst : s.reason;
    const bool unnamed = hazard == safety::Hazard::None;
    stopped_because_ = fmt::format("{}: {}", safety::name_of(s.permit.mode),
                                   unnamed ? safety::name_of(s.event) : safety::name_of(hazard));
  }

  void give_up(const CycleRecord& seen) {
    note(seen);
    go(Step::Withdraw);
  }

  void watch(const CycleRecord& seen, bool played, bool holds) {
    const Mode mode = seen.supervisor.permit.mode;
    const bool off = mode == Mode::Safe || mode == Mode::Ready || mode == Mode::Trip || mode == Mode::Lock;
    switch (step_) {
      case Step::WaitReady:
        if (mode == Mode::Ready && rested_ && waited_ > kThink_ticks) return go(Step::Arm);
        if (mode == Mode::Trip || mode == Mode::Lock || waited_ > rest_ticks_ + kReadyMax_ticks)
          give_up(seen);
        return;
      case Step::Arm:
        if (mode == Mode::Armed && !std::exchange(armed_, true) && by_hand_) waited_ = 0;
        if (mode == Mode::Armed && waited_ > (by_hand_ ? kHandsOff_ticks : kThink_ticks))
          return go(Step::Run);
        if (armed_ && mode != Mode::Armed) return give_up(seen);
        if (waited_ <= (by_hand_ ? kHand_ticks : 1) || mode == Mode::Armed) return;
        give_up(seen);
        if (by_hand_ && mode == Mode::Ready) stopped_because_ = "nobody turned the arm key";
        return;
      case Step::Run:
        if (played) return go(Step::Withdraw);
        if (waited_ > 1 && mode != Mode::Active && !(mode == Mode::Hold && holds)) give_up(seen);
        return;
      case Step::Withdraw:
        if ((mode == Mode::Trip || mode == Mode::Lock) && stopped_because_.empty()) note(seen);
        if (off && waited_ > kReturn_ticks) go(Step::Done);
        return;
      case Step::Done:
        return;
    }
  }

  bool by_hand_, key_was_open_ = false, armed_ = false;
  std::int64_t rest_ticks_;
  bool rested_;
  Step step_ = Step::WaitReady;
  std::int64_t waited_ = 0;
  std::string stopped_because_;
};

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
  ControlCycle stage(plan, facts, bench.stage, {tag, tag});
  const std::uint32_t length = control::length_ticks(run.program);
  BenchResult result;
  result.recorded.name = run.name;
  result.recorded.file = "run-" + run.name + ".csv";
  result.recorded.weight = run.setup.weight.value * 1e-3;
  BenchOperator person(static_cast<bool>(bench.keys), std::llround(bench.rest / Seconds(kTick)));
  control::ProgramState state;
  CycleRecord seen;
  double push_N = 0.0;
  for (bool played = false, asked = false; !person.done();) {
    if (bench.stop && bench.stop()) person.stop();
    const bool recorded = person.recorded();
    const BenchKeys keys = bench.keys ? bench.keys() : BenchKeys{.arm = false, .estop_closed = true};
    OperatorInputs inputs = person.act(seen, played, state.ticks >= run.program.hold_from_tick, keys.arm);
    inputs.estop_closed = keys.estop_closed;
    if (person.asks_for_key() && !std::exchange(asked, true) && bench.ask_for_key) bench.ask_for_key();
    if (person.running()) push_N = push_at(run, state.ticks);
    bench.push(push_N);
    seen = stage.run(
        inputs, Environment::healthy(), [&](const Measurement&, const safety::SupervisorOutput& decided) {
          const control::ProgramStep next = control::play(run.program, state, decided.permit, inputs.finish);
          state = next.state;
          return next.request;
        });
    if (bench.supervisor_pulse != nullptr && seen.supervisor.interlock_pulse) bench.supervisor_pulse->pulse();
    played = played || control::is_played(run.program, state);
    if (recorded) record(result.recorded, seen, push_N);
    if (result.stopped_s == 0.0 && !person.stopped_because().empty() && !result.recorded.time.empty())
      result.stopped_s = result.recorded.time.back();
    if (stage.ticks() % kToldEvery_ticks == 0) bench.played(state.ticks / static_cast<double>(length));
  }
  result.stopped_because = person.stopped_because();
  return result;
}

}  // namespace biopsy::robot
