#include "robot/ros2/bus_observer.hpp"

#include "planner/plan/open_plan.hpp"

namespace biopsy::ros2 {
namespace {

constexpr std::int64_t kFresh_us = 500'000;

bool is_fresh(std::int64_t since_us, std::int64_t now_us) {
  return since_us != 0 && now_us - since_us < kFresh_us;
}

}  // namespace

BusObserver::BusObserver(const transport::Participant& bus)
    : measurements_(bus), decisions_(bus), plans_(bus), board_(bus) {}

RobotState BusObserver::state(std::int64_t now_us) {
  if (measurements_.take_newest(measurement_) > 0) measured_us_ = now_us;
  if (decisions_.take_newest(decision_) > 0) decided_us_ = now_us;
  SealedPlan sealed;
  if (plans_.take_newest(sealed) > 0) {
    X_SR_.reset();
    const auto plan = planner::open_plan(sealed.bytes, sealed.seal);
    if (plan && !plan->bench) X_SR_ = plan->X_SR;
  }
  board_.update(now_us);
  RobotState state;
  if (is_fresh(measured_us_, now_us)) state.measurement = measurement_;
  if (is_fresh(decided_us_, now_us)) state.decision = decision_;
  state.X_SR = X_SR_;
  for (std::size_t i = 0; i < kCount<Process>; ++i)
    state.health[i] = board_.of(static_cast<Process>(i), now_us);
  return state;
}

}  // namespace biopsy::ros2
