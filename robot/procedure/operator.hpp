// The person of a rehearsal, as a script: arms, holds the button while the needle moves, lets go at each
// stage's end, has an image taken where the plan wants one, goes on when it is accepted, and withdraws at the
// end.
#pragma once

#include <cstdint>
#include <string>

#include "robot/cycle/simulated_robot.hpp"

namespace biopsy::robot {

enum class Step : std::uint8_t { WaitReady, Arm, Press, Insert, Image, Judge, Pause, Withdraw, Done };

class Operator {
 public:
  explicit Operator(const Plan& plan) : plan_(plan) {}

  // What the person does in this tick, having seen the last one.
  World act(const CycleRecord& seen, std::int64_t tick);

  // The image of the present stage is complete: it must be judged before the next act().
  bool wants_verdict() const { return step_ == Step::Judge; }
  void judge(bool accepted, const std::string& reason);

  bool done() const { return step_ == Step::Done; }
  bool completed() const { return completed_; }
  // Why the procedure ended early; empty if it did not.
  const std::string& stopped_because() const { return stopped_because_; }
  Step step() const { return step_; }

 private:
  void go(Step step, std::int64_t tick);
  void give_up(const std::string& reason);
  void watch(const CycleRecord& seen, std::int64_t tick);

  const Plan& plan_;
  Step step_ = Step::WaitReady;
  std::int64_t since_ = 0;   // tick at which the step began
  std::uint32_t token_ = 0;  // of the present press
  std::uint32_t accepted_stage_ = 0;
  bool accepted_ = false, completed_ = false;
  int repeated_presses_ = 0;
  std::string stopped_because_;
};

inline constexpr std::int64_t kAcquisition_ticks = 2000;  // one fast gradient-echo stack through the needle

}  // namespace biopsy::robot
