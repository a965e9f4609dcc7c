#include "robot/live/controller_loop.hpp"

#include "planner/plan/open_plan.hpp"
#include "planner/plan/seal.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::live {

namespace {

constexpr std::uint32_t kTogether = 2;

}  // namespace

ControllerLoop::ControllerLoop(const transport::Participant& bus, std::uint64_t config_tag)
    : measurements_(bus),
      permits_(bus),
      decisions_(bus),
      acts_(bus),
      plans_(bus),
      requests_(bus),
      wait_set_(bus),
      heartbeat_(bus, Process::Controller, config_tag),
      config_tag_(config_tag) {
  wait_set_.add(measurements_);
}

// A plan is taken up at rest only. One that comes later is left where it is: the supervisor stops for it.
void ControllerLoop::take_plan() {
  if (permit_.hv_enable) return;
  SealedPlan sealed;
  if (plans_.take_newest(sealed) == 0) return;
  plan_ = planner::open_plan(sealed.bytes, sealed.seal);
  if (plan_ && plan_->stages.empty()) plan_.reset();
  const std::uint32_t seq = runner_.seq;
  runner_ = {};
  runner_.seq = seq;  // the gate and the supervisor know our requests by their numbers
  plan_tag_ = plan_ ? planner::plan_tag(*plan_) : 0;
  heartbeat_.health().plan_tag = plan_tag_;
  heartbeat_.health().ready = plan_.has_value();
  heartbeat_.health().note = plan_ ? "" : "the plan's seal does not hold";
}

DriveRequest ControllerLoop::answer(const Measurement& measured) {
  DriveRequest request;
  const bool drivable = plan_ && decision_.stage < plan_->stages.size();
  if (drivable) {
    const control::RunnerStep step =
        control::run_stage(*plan_, {}, runner_, measured, permit_, decision_.stage, act_.finish);
    runner_ = step.state;
    request = step.request;
  } else {
    request.seq = ++runner_.seq;  // alive, and asks for nothing
    request.measured_seq = measured.seq;
  }
  request.overruns = overruns_;
  request.plan_tag = plan_tag_;
  request.config_tag = config_tag_;
  return request;
}

void ControllerLoop::turn(std::chrono::nanoseconds patience) {
  wait_set_.wait(patience);
  const std::int64_t woke_ns = realtime::monotonic_ns();
  permits_.take_newest(permit_);
  decisions_.take_newest(decision_);
  acts_.take_newest(act_);
  // Each is answered, in order. Two together are the jitter of their arrival; more were not answered in time.
  std::uint32_t count = 0;
  for (Measurement measured; measurements_.take(measured); ++count) requests_.write(answer(measured));
  if (count > kTogether) overruns_ += count - kTogether;
  if (count > 0) heartbeat_.lateness().record(realtime::monotonic_ns() - woke_ns);
  take_plan();
  heartbeat_.health().overruns = overruns_;
  heartbeat_.beat(woke_ns / 1000);
}

}  // namespace biopsy::live
