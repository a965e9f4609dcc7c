#include "robot/procedure/operator.hpp"

#include <fmt/format.h>

namespace biopsy::robot {
namespace {

constexpr std::int64_t kThink_ticks = 300;       // between two acts of a hand
constexpr std::int64_t kReadyMax_ticks = 5'000;  // a healthy robot is ready within seconds
constexpr std::int64_t kAnswerMax_ticks =
    200;  // from a press to motion, over a bus; afterwards it was refused
constexpr std::int64_t kStepMax_ticks = 60'000;  // a step that is not reached in a minute never will be
constexpr std::int64_t kReturn_ticks = 1'500;    // time for gravity to withdraw the needle
constexpr std::int64_t kQuiet_ticks = 200;       // vibration of the brake has died away
constexpr std::int64_t kLockMax_ticks = 3'000;   // ten times what a sound brake and a ramp take
constexpr int kPressesMax = 5;                   // unexpected holds before an operator gives up
constexpr int kRepeatedImagesMax = 1;            // of a step: a hold lasts 10 s

}  // namespace

Operator::Operator(const Plan& plan, Seconds scan)
    : plan_(plan), scan_ticks_(static_cast<std::int64_t>(scan / Seconds(kTick))) {}

void Operator::go(Phase phase, std::int64_t tick) {
  phase_ = phase;
  since_ = tick;
}

void Operator::observe(const CycleRecord& seen) {
  const safety::SupervisorOutput& last = seen.supervisor;
  const Mode mode = last.permit.mode;
  moved_ = moved_ || mode == Mode::Active;
  if (mode == Mode::Active) patient_moved_ = false;
  patient_moved_ = patient_moved_ || names_patient_motion(last);
  const bool ended = mode == Mode::Trip || mode == Mode::Lock || mode == Mode::Retract;
  if (!ended || !ended_because_.empty()) return;
  ended_because_ = fmt::format("{}: {}", safety::name_of(mode), cause_of(last, seen.panel_unread_ms));
}

void Operator::give_up(const std::string& reason) {
  if (stopped_because_.empty()) stopped_because_ = reason;
}

void Operator::judge(DepthVerdict verdict, const std::string& reason, std::int32_t patient_motion_um) {
  patient_motion_um_ = patient_motion_um;
  judged_ = true;
  // An image whose hold was ended shows a needle on its way back: that is why the procedure stops.
  if (!ended_because_.empty()) give_up(ended_because_);
  accepted_ = verdict == DepthVerdict::Accept;
  refuse_moved_patient();
  if (verdict == DepthVerdict::Unsure && repeated_images_ < kRepeatedImagesMax) {
    ++repeated_images_;
    phase_ = Phase::Image;
    return;
  }
  repeated_images_ = 0;
  if (!accepted_) give_up(reason);
  phase_ = Phase::Pause;
}

// No depth is accepted, or stays so, of a patient who moved while the needle is held there.
void Operator::refuse_moved_patient() {
  if (!accepted_ || !patient_moved_ || completed_) return;
  accepted_ = false;
  give_up("the patient moved by more than 2 mm while the needle was held: take a new image and plan anew");
}

void Operator::follow_insertion(const CycleRecord& seen, std::int64_t tick) {
  const std::int64_t waited = tick - since_;
  const bool held = seen.supervisor.permit.mode == Mode::Hold && (moved_ || waited > kAnswerMax_ticks);
  if (held && moved_ && seen.supervisor.step_done) {
    accepted_step_ = seen.supervisor.step;
    accepted_ = !plan_.steps[accepted_step_].image_confirms;
    refuse_moved_patient();
    completed_ = accepted_ && accepted_step_ + 1 == plan_.steps.size();
    const Phase image = seen.measurement.brake_fitted ? Phase::Lock : Phase::Image;
    go(accepted_ ? Phase::Pause : image, tick);
  } else if (held && ++repeated_presses_ <= kPressesMax) {
    go(Phase::Pause, tick);
  } else if (held) {
    give_up(
        fmt::format("held again and again: {}", hazard_text(seen.supervisor.reason, seen.panel_unread_ms)));
    go(Phase::Withdraw, tick);
  } else if (waited > kStepMax_ticks) {
    give_up(
        fmt::format("step {} was not reached within {} s", seen.supervisor.step + 1, kStepMax_ticks / 1000));
    go(Phase::Withdraw, tick);
  }
}

void Operator::follow_lock(const CycleRecord& seen, std::int64_t tick) {
  if (!is_quiet(seen)) quiet_since_ = tick;
  if (tick - quiet_since_ >= kQuiet_ticks) go(Phase::Image, tick);
  if (phase_ != Phase::Lock || tick - since_ < kLockMax_ticks) return;
  give_up("the brake did not lock the needle for its image");
  go(Phase::Withdraw, tick);
}

// Advances the script; the inputs are then a function of the phase.
void Operator::follow(const CycleRecord& seen, std::int64_t tick) {
  if (judged_) since_ = tick - 1;  // whatever time the check took
  judged_ = false;
  const std::int64_t waited = tick - since_;
  const Mode mode = seen.supervisor.permit.mode;
  observe(seen);
  if (!ended_because_.empty() && phase_ != Phase::Withdraw && phase_ != Phase::Done) {
    give_up(ended_because_);
    go(Phase::Withdraw, tick);
    return;
  }
  switch (phase_) {
    case Phase::WaitReady:
      if (mode == Mode::Ready && waited > kThink_ticks) go(Phase::Arm, tick);
      if (waited <= kReadyMax_ticks) break;
      give_up(fmt::format("not ready: {}", hazard_text(seen.supervisor.worst, seen.panel_unread_ms)));
      go(Phase::Withdraw, tick);
      break;
    case Phase::Arm:
      if (seen.supervisor.worst != safety::Hazard::None)
        refused_by_ = hazard_text(seen.supervisor.worst, seen.panel_unread_ms);
      if (waited <= kThink_ticks) break;
      // A moment's hazard refuses an arming, and the key must be turned again.
      if (mode == Mode::Armed || ++repeated_presses_ <= kPressesMax)
        return go(mode == Mode::Armed ? Phase::Press : Phase::WaitReady, tick);
      give_up(fmt::format("arming was refused {} times; last by: {}", kPressesMax + 1, refused_by_));
      go(Phase::Withdraw, tick);
      break;
    case Phase::Press:
      ++token_;
      moved_ = false;
      go(Phase::Insert, tick);
      break;
    case Phase::Insert:
      follow_insertion(seen, tick);
      break;
    case Phase::Lock:
      follow_lock(seen, tick);
      break;
    case Phase::Image: {
      const Seconds scan = scan_time(seen.measurement.brake_fitted, scan_ticks_ * Seconds(kTick));
      if (waited * Seconds(kTick) >= scan) go(Phase::Judge, tick);
      break;
    }
    case Phase::Judge:
      break;
    case Phase::Pause: {
      if (waited < kThink_ticks) break;
      refuse_moved_patient();
      const bool all = accepted_ && accepted_step_ + 1 == plan_.steps.size();
      completed_ = completed_ || all;
      go(all || !stopped_because_.empty() ? Phase::Withdraw : Phase::Press, tick);
      break;
    }
    case Phase::Withdraw:
      if ((mode == Mode::Safe || mode == Mode::Ready || mode == Mode::Trip || mode == Mode::Lock) &&
          waited > kReturn_ticks)
        go(Phase::Done, tick);
      break;
    case Phase::Done:
      break;
  }
}

OperatorInputs Operator::act(const CycleRecord& seen, std::int64_t tick) {
  follow(seen, tick);
  OperatorInputs inputs = OperatorInputs::idle();
  inputs.arm = phase_ == Phase::Arm;
  inputs.press = {phase_ == Phase::Insert ? token_ : 0, phase_ == Phase::Insert};
  inputs.acquiring = phase_ == Phase::Image || phase_ == Phase::Judge;  // a scanner's image is waited for
  if (inputs.acquiring && !imaging_) imaged_under_ = seen.supervisor.permit;
  imaging_ = inputs.acquiring;
  inputs.hold_still = phase_ == Phase::Lock || inputs.acquiring;
  inputs.finish = phase_ == Phase::Withdraw;
  inputs.patient_motion_um = patient_motion_um_;
  inputs.depth_accepted = accepted_;
  inputs.accepted_step = accepted_step_;
  inputs.accepted_session = imaged_under_.session;
  inputs.accepted_since_seq = imaged_under_.seq;
  return inputs;
}

}  // namespace biopsy::robot
