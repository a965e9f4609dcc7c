#include "robot/procedure/operator.hpp"

#include <fmt/format.h>

namespace biopsy::robot {
namespace {

constexpr std::int64_t kThink_ticks = 300;        // between two acts of a hand
constexpr std::int64_t kReadyMax_ticks = 5'000;   // a healthy robot is ready within seconds
constexpr std::int64_t kStageMax_ticks = 60'000;  // a stage that is not reached in a minute never will be
constexpr std::int64_t kReturn_ticks = 1'500;     // time for gravity to withdraw the needle
constexpr int kPressesMax = 5;                    // holds that were not asked for, before a person gives up

}  // namespace

void Operator::go(Step step, std::int64_t tick) {
  step_ = step;
  since_ = tick;
}

void Operator::give_up(const std::string& reason) {
  if (stopped_because_.empty()) stopped_because_ = reason;
}

void Operator::judge(bool accepted, const std::string& reason) {
  accepted_ = accepted;
  if (!accepted) give_up(reason);
  step_ = Step::Pause;
}

// Moves the script on; World is then read off the step.
void Operator::watch(const CycleRecord& seen, std::int64_t tick) {
  const std::int64_t waited = tick - since_;
  const Mode mode = seen.supervisor.permit.mode;
  const bool ended = mode == Mode::Trip || mode == Mode::Lock || mode == Mode::Retract;
  if (ended && step_ != Step::Withdraw && step_ != Step::Done) {
    give_up(fmt::format("{}: {}", safety::name_of(mode), safety::name_of(seen.supervisor.reason)));
    go(Step::Withdraw, tick);
    return;
  }
  switch (step_) {
    case Step::WaitReady:
      if (mode == Mode::Ready && waited > kThink_ticks) go(Step::Arm, tick);
      if (waited <= kReadyMax_ticks) break;
      give_up(fmt::format("not ready: {}", safety::name_of(seen.supervisor.worst)));
      go(Step::Withdraw, tick);
      break;
    case Step::Arm:
      if (mode == Mode::Armed && waited > kThink_ticks) go(Step::Press, tick);
      break;
    case Step::Press:
      ++token_;
      go(Step::Insert, tick);
      break;
    case Step::Insert: {
      const bool held = mode == Mode::Hold && waited > 1;
      const bool last = seen.supervisor.stage + 1 == plan_.stages.size();
      if (held && seen.supervisor.stage_done) {
        accepted_stage_ = seen.supervisor.stage;
        accepted_ = false;
        if (plan_.stages[accepted_stage_].image_confirms) {
          go(Step::Image, tick);
        } else {
          accepted_ = true;
          completed_ = last;
          go(Step::Pause, tick);
        }
      } else if (held && ++repeated_presses_ <= kPressesMax) {
        go(Step::Pause, tick);
      } else if (held || waited > kStageMax_ticks) {
        give_up(held ? fmt::format("held again and again: {}", safety::name_of(seen.supervisor.reason))
                     : fmt::format("stage {} was not reached within {} s", seen.supervisor.stage + 1,
                                   kStageMax_ticks / 1000));
        go(Step::Withdraw, tick);
      }
      break;
    }
    case Step::Image:
      if (waited >= kAcquisition_ticks) go(Step::Judge, tick);
      break;
    case Step::Judge:
      break;
    case Step::Pause: {
      if (waited < kThink_ticks) break;
      const bool all = accepted_ && accepted_stage_ + 1 == plan_.stages.size();
      completed_ = completed_ || all;
      go(all || !stopped_because_.empty() ? Step::Withdraw : Step::Press, tick);
      break;
    }
    case Step::Withdraw:
      if ((mode == Mode::Safe || mode == Mode::Ready || mode == Mode::Trip || mode == Mode::Lock) &&
          waited > kReturn_ticks)
        go(Step::Done, tick);
      break;
    case Step::Done:
      break;
  }
}

World Operator::act(const CycleRecord& seen, std::int64_t tick) {
  watch(seen, tick);
  World world;
  world.arm = step_ == Step::Arm;
  world.press = {step_ == Step::Insert ? token_ : 0, step_ == Step::Insert};
  world.acquiring = step_ == Step::Image;
  world.finish = step_ == Step::Withdraw;
  world.depth_accepted = accepted_;
  world.accepted_stage = accepted_stage_;
  return world;
}

}  // namespace biopsy::robot
