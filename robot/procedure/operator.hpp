// The operator of a rehearsal, as a script: arms, holds the button while the needle moves, releases it at
// each step's end, has the needle locked and an image taken where the plan wants one (once more where it is
// unsure), goes on when it is accepted, and withdraws at the end.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "robot/cycle/simulated_robot.hpp"
#include "robot/msg/depth_check.hpp"

namespace biopsy::robot {

class Operator {
 public:
  // `scan`: how long an image takes where the stage can lock the needle.
  Operator(const Plan& plan, Seconds scan);

  // Every tick of the robot, in order. A ramp down may be over before the operator acts on the newest tick
  // again.
  void observe(const CycleRecord& seen);

  // What the operator does in tick `tick`, having seen the newest one.
  OperatorInputs act(const CycleRecord& seen, std::int64_t tick);

  // The image of the present step is complete: it must be judged before the next act().
  bool wants_verdict() const { return phase_ == Phase::Judge; }
  // `patient_motion_um`: since the plan's image, as this one shows it.
  void judge(DepthVerdict verdict, const std::string& reason, std::int32_t patient_motion_um = 0);

  bool done() const { return phase_ == Phase::Done; }
  bool completed() const { return completed_; }
  // Why the procedure ended early; empty if it did not.
  const std::string& stopped_because() const { return stopped_because_; }

 private:
  enum class Phase : std::uint8_t {
    WaitReady,
    Arm,
    Press,
    Insert,
    Lock,
    Image,
    Judge,
    Pause,
    Withdraw,
    Done
  };

  void go(Phase phase, std::int64_t tick);
  void give_up(const std::string& reason);
  void follow(const CycleRecord& seen, std::int64_t tick);
  void refuse_moved_patient();
  void follow_insertion(const CycleRecord& seen, std::int64_t tick);
  void follow_lock(const CycleRecord& seen, std::int64_t tick);

  const Plan& plan_;
  const std::int64_t scan_ticks_;
  Phase phase_ = Phase::WaitReady;
  std::int64_t since_ = 0;  // tick at which the phase began
  std::int64_t quiet_since_ = 0;
  bool judged_ = false;      // since the last act()
  bool moved_ = false;       // the needle was driven since the last press
  std::uint32_t token_ = 0;  // of the present press
  std::uint32_t accepted_step_ = 0;
  Permit imaged_under_;  // in force when the last image began to be taken
  bool imaging_ = false;
  bool patient_moved_ = false;  // since the needle arrived where it is held
  std::int32_t patient_motion_um_ = 0;
  bool accepted_ = false, completed_ = false;
  int repeated_presses_ = 0, repeated_images_ = 0;
  std::string refused_by_ = "no hazard that was told";  // the last arming
  std::string ended_because_;  // the robot ended the insertion; empty while it did not
  std::string stopped_because_;
};

// One fast gradient-echo stack through the needle: what a hold without a brake has time for.
inline constexpr Seconds kFastScan{2.0};
// Confirmation images take 20 to 60 s.
inline constexpr Seconds kRealScan{20.0};

// How long an image of this stage takes in a rehearsal.
constexpr Seconds scan_time(bool brake_fitted, Seconds scan) {
  return brake_fitted ? scan : std::min(scan, kFastScan);
}
// The patient is more than 2 mm from where the plan has them, or it is not known where they are (H-22).
inline bool names_patient_motion(const safety::SupervisorOutput& supervisor) {
  return supervisor.worst == safety::Hazard::PatientMotion ||
         supervisor.reason == safety::Hazard::PatientMotion;
}

// The needle is locked, and there is no voltage that could switch.
inline bool is_quiet(const CycleRecord& seen) {
  return seen.measurement.brake_on && seen.drive_mV == 0;
}

}  // namespace biopsy::robot
