// The operator of a rehearsal, as a script: arms, holds the button while the needle moves, releases it at
// each step's end, has an image taken where the plan wants one (once more where it is unsure), goes on when
// it is accepted, and withdraws at the end.
#pragma once

#include <cstdint>
#include <string>

#include "robot/cycle/simulated_robot.hpp"
#include "robot/msg/depth_check.hpp"

namespace biopsy::robot {

class Operator {
 public:
  explicit Operator(const Plan& plan) : plan_(plan) {}

  // Every tick of the robot, in order.
  void observe(const CycleRecord& seen) { moved_ = moved_ || seen.supervisor.permit.mode == Mode::Active; }

  // What the operator does in tick `tick`, having seen the newest one.
  OperatorInputs act(const CycleRecord& seen, std::int64_t tick);

  // The image of the present step is complete: it must be judged before the next act().
  bool wants_verdict() const { return phase_ == Phase::Judge; }
  void judge(DepthVerdict verdict, const std::string& reason);

  bool done() const { return phase_ == Phase::Done; }
  bool completed() const { return completed_; }
  // Why the procedure ended early; empty if it did not.
  const std::string& stopped_because() const { return stopped_because_; }

 private:
  enum class Phase : std::uint8_t { WaitReady, Arm, Press, Insert, Image, Judge, Pause, Withdraw, Done };

  void go(Phase phase, std::int64_t tick);
  void give_up(const std::string& reason);
  void follow(const CycleRecord& seen, std::int64_t tick);
  void follow_insertion(const CycleRecord& seen, std::int64_t tick);

  const Plan& plan_;
  Phase phase_ = Phase::WaitReady;
  std::int64_t since_ = 0;   // tick at which the phase began
  bool judged_ = false;      // since the last act()
  bool moved_ = false;       // the needle was driven since the last press
  std::uint32_t token_ = 0;  // of the present press
  std::uint32_t accepted_step_ = 0;
  bool accepted_ = false, completed_ = false;
  int repeated_presses_ = 0, repeated_images_ = 0;
  std::string stopped_because_;
};

inline constexpr std::int64_t kAcquisition_ticks = 2000;  // one fast gradient-echo stack through the needle

}  // namespace biopsy::robot
