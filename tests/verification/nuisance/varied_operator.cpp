#include "tests/verification/nuisance/varied_operator.hpp"

#include "robot/procedure/operator.hpp"

namespace biopsy::fault_injection {
namespace {

constexpr double kGivesUp = 0.15;              // of all procedures
constexpr std::int32_t kReturn_ticks = 1'500;  // gravity withdraws the needle
constexpr std::int32_t kPatience_ticks = 500;
constexpr std::int32_t kForever = 1'000'000'000;

}  // namespace

VariedOperator::VariedOperator(const Plan& plan, std::uint64_t seed)
    : plan_(plan), draw_(seed), left_(draw_.whole(100, 3'000)) {
  gives_up_ = draw_.within(0.0, 1.0) < kGivesUp;
  quits_in_ = gives_up_ ? draw_.whole(1'000, 15'000) : kForever;
  by_stop_ = draw_.coin();
}

void VariedOperator::go(Step step, std::int32_t ticks) {
  step_ = step;
  left_ = ticks;
}

// The stage is done: an image where the plan wants one, then on; at the last one, back.
void VariedOperator::reach(const robot::CycleRecord& seen) {
  held_ = false;
  accepted_step_ = seen.supervisor.step;
  accepted_ = !plan_.steps[accepted_step_].image_confirms;
  if (accepted_) completed_ = accepted_step_ + 1 == plan_.steps.size();
  if (!accepted_)
    go(seen.measurement.brake_fitted ? Step::Lock : Step::Image,
       static_cast<std::int32_t>(robot::kFastScan / Seconds(kTick)));
  else
    go(completed_ ? Step::Withdraw : Step::Think, draw_.whole(150, 4'000));
}

void VariedOperator::insert(const robot::CycleRecord& seen) {
  const Mode mode = seen.supervisor.permit.mode;
  if (mode == Mode::Hold && seen.supervisor.step_done && held_) return reach(seen);
  held_back_ = mode == Mode::Hold ? held_back_ + 1 : 0;
  if (held_back_ >= kPatience_ticks) {  // stopped for no reason of theirs: lets go and tries again
    held_ = false;
    return go(Step::Think, draw_.whole(150, 1'000));
  }
  if (--left_ > 0) return;
  held_ = false;  // lets go in the middle of it
  ++releases_;
  go(Step::Think, draw_.whole(150, 5'000));
}

void VariedOperator::watch(const robot::CycleRecord& seen) {
  const Mode mode = seen.supervisor.permit.mode;
  const bool stopped = mode == Mode::Retract || mode == Mode::Trip || mode == Mode::Lock;
  if (step_ != Step::Withdraw && step_ != Step::Done && (stopped || --quits_in_ == 0)) {
    held_ = false;
    return go(Step::Withdraw, kReturn_ticks + draw_.whole(0, 2'000));
  }
  switch (step_) {
    case Step::Wait:
      if (mode == Mode::Ready && --left_ <= 0) go(Step::Arm, 50);
      break;
    case Step::Arm:
      if (--left_ <= 0) go(Step::Think, draw_.whole(150, 8'000));
      break;
    case Step::Think:
      if (--left_ > 0) break;
      ++token_;
      held_ = true;
      go(Step::Insert, draw_.within(0.0, 1.0) < 0.3 ? draw_.whole(200, 4'000) : kForever);
      break;
    case Step::Insert:
      insert(seen);
      break;
    case Step::Lock:
      if (robot::is_quiet(seen)) go(Step::Image, draw_.whole(20'000, 60'000));
      break;
    case Step::Image:
      if (--left_ > 0) break;
      accepted_ = true;
      completed_ = accepted_step_ + 1 == plan_.steps.size();
      go(completed_ ? Step::Withdraw : Step::Think, completed_ ? kReturn_ticks : draw_.whole(150, 4'000));
      break;
    case Step::Withdraw:
      if ((mode == Mode::Safe || mode == Mode::Ready || mode == Mode::Trip || mode == Mode::Lock) &&
          --left_ <= 0)
        step_ = Step::Done;
      break;
    case Step::Done:
      break;
  }
}

robot::OperatorInputs VariedOperator::act(const robot::CycleRecord& seen) {
  watch(seen);
  robot::OperatorInputs world = robot::OperatorInputs::idle();
  world.arm = step_ == Step::Arm;
  world.press = {token_, held_};
  world.acquiring = step_ == Step::Image;
  world.hold_still = step_ == Step::Lock || world.acquiring;
  world.finish = step_ == Step::Withdraw && !(by_stop_ && gave_up());
  if (step_ == Step::Withdraw && by_stop_ && gave_up()) world.stop = StopCategory::C1Ramp;
  world.depth_accepted = accepted_;
  world.accepted_step = accepted_step_;
  if (world.acquiring && !imaging_) imaged_under_ = seen.supervisor.permit;
  imaging_ = world.acquiring;
  world.accepted_session = imaged_under_.session;
  world.accepted_since_seq = imaged_under_.seq;
  return world;
}

}  // namespace biopsy::fault_injection
