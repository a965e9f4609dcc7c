#include "robot/live/controller_loop.hpp"

#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::live {
namespace {

constexpr std::uint32_t kJitter = 2;  // measurements that may arrive together; more were not answered in time

}  // namespace

ControllerLoop::ControllerLoop(const transport::Participant& bus, std::uint64_t config_tag)
    : measurements_(bus),
      permits_(bus),
      decisions_(bus),
      acts_(bus),
      plans_(bus),
      requests_(bus),
      wait_set_(bus),
      heartbeat_(bus, Process::Controller, config_tag) {
  controller_.config_tag = config_tag;
  wait_set_.add(measurements_);
}

// At rest only: the supervisor stops for a plan that comes in motion.
void ControllerLoop::take_plan() {
  if (inputs_.permit.hv_enable) return;
  SealedPlan sealed;
  if (plans_.take_newest(sealed) == 0) return;
  robot::load_plan(sealed, controller_);
  heartbeat_.health().plan_tag = controller_.plan_tag;
  heartbeat_.health().ready = controller_.plan.has_value();
  heartbeat_.health().note = controller_.plan ? "" : "the plan's seal does not hold";
}

void ControllerLoop::turn(std::chrono::nanoseconds timeout) {
  wait_set_.wait(timeout);
  const std::int64_t woke_ns = realtime::monotonic_ns();
  permits_.take_newest(inputs_.permit);
  if (decisions_.take_newest(decision_) > 0) inputs_.step = decision_.step;
  if (acts_.take_newest(act_) > 0) inputs_.finish = act_.finish, inputs_.hold_still = act_.hold_still;
  std::uint32_t count = 0;
  for (; measurements_.take(inputs_.measurement); ++count)
    requests_.write(robot::control(inputs_, controller_));
  if (count > kJitter) inputs_.overruns += count - kJitter;
  if (count > 0) heartbeat_.lateness().record(realtime::monotonic_ns() - woke_ns);
  take_plan();
  heartbeat_.health().overruns = inputs_.overruns;
  heartbeat_.beat(woke_ns / 1000);
}

}  // namespace biopsy::live
