// The operator of a stage without patient and needle, as a script: waits until the robot is ready, arms,
// holds the button while the program is played, withdraws.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/pulse_output.hpp"
#include "robot/control/voltage_program.hpp"
#include "robot/cycle/run_cycle.hpp"

namespace biopsy::robot {

// Times in ticks of 1 ms.
struct BenchScript {
  std::int64_t act_after = 300;          // in a mode, before the next one is requested
  std::int64_t withdrawn_after = 1'500;  // behind the end of the voltage: gravity brings the stage back
  std::int64_t rest = 0;                 // at 0 V before that
  bool by_hand = false;                  // the arm key is a real one
};

class BenchOperator {
 public:
  explicit BenchOperator(const BenchScript& script) : script_(script), rested_(script.rest <= 0) {}

  // The inputs of the next tick. `seen`: the last one; `done`: the voltage is no longer wanted; `holds`: the
  // program allows a hold; `key`: position of the real arm key.
  OperatorInputs act(const CycleRecord& seen, bool done, bool holds, bool key);
  void interrupt();  // withdraws as at any stop

  // A real key counts only after it was seen open in this phase.
  bool requests_key() const { return phase_ == Phase::Arm; }
  // Rows are kept from here on: after the rest or, with a real key, once the robot is armed.
  bool recorded() const { return script_.by_hand ? armed_ : rested_; }
  bool running() const { return phase_ == Phase::Run; }
  bool finished() const { return phase_ == Phase::Finished; }
  const std::string& stopped_because() const { return stopped_because_; }  // empty: the program was played

 private:
  enum class Phase : std::uint8_t { Ready, Arm, Run, Withdraw, Finished };

  void enter(Phase phase) { phase_ = phase, waited_ = 0; }
  void note_reason(const CycleRecord& seen);
  void give_up(const CycleRecord& seen);
  void follow(const CycleRecord& seen, bool done, bool holds);
  void follow_arming(const CycleRecord& seen);

  BenchScript script_;
  bool rested_, armed_ = false, key_was_open_ = false;
  Phase phase_ = Phase::Ready;
  std::int64_t waited_ = 0;  // in this phase
  std::string stopped_because_;
};

// One tick of the program under the supervisor, which pulses `supervisor_pulse` where there is one.
CycleRecord play_tick(ControlCycle& cycle, const control::VoltageProgram& program,
                      control::ProgramState& state, const OperatorInputs& inputs,
                      drivers::PulseOutput* supervisor_pulse);

}  // namespace biopsy::robot
