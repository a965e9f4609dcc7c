#include "robot/igtl/bus_robot.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "robot/cycle/stop_cause.hpp"
#include "robot/msg/enum_traits.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::igtl {
namespace {

constexpr std::int64_t kFresh_us = 500'000, kSendEvery_us = 100'000;

// What ended or prevents motion, in the supervisor's words.
std::string hazard_of(const Decision& decision) {
  const bool stopped = decision.mode == Mode::Hold || decision.mode == Mode::Retract ||
                       decision.mode == Mode::Trip || decision.mode == Mode::Lock;
  const auto hazard = static_cast<safety::Hazard>(stopped ? decision.reason : decision.worst);
  if (hazard != safety::Hazard::None) return robot::hazard_text(hazard, decision.panel_unread_ms);
  const auto event = static_cast<safety::Event>(decision.event);
  return stopped && event != safety::Event::None ? std::string(safety::name_of(event)) : std::string();
}

std::array<std::int32_t, 3> micrometres(const Point& lps_mm) {
  const Point ras = ras_from_lps(lps_mm) * 1e3;
  std::array<std::int32_t, 3> whole{};
  for (int axis = 0; axis < 3; ++axis)
    whole[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(std::lround(ras(axis)));
  return whole;
}

}  // namespace

NavigationRequest request_of(const Wish& wish) {
  NavigationRequest request;
  request.stop = wish.stop;
  request.wants_motion = wish.motion;
  request.measures_patient = wish.patient_motion.has_value();
  if (wish.patient_motion)  // unknown, or beyond what the field holds: the most that it holds
    request.patient_motion_um =
        static_cast<std::int32_t>(std::lround(std::min(wish.patient_motion->value * 1e3, 2147483647.0)));
  request.proposal = wish.proposal;
  for (int column = 0; column < 3; ++column) {
    const Point axis = ras_from_lps(wish.X_SR.linear().col(column)) * 1e9;
    for (int row = 0; row < 3; ++row)
      request.rotation_ppb[static_cast<std::size_t>(3 * row + column)] =
          static_cast<std::int32_t>(std::lround(axis(row)));
  }
  request.origin_um = micrometres(wish.X_SR.translation());
  request.target_um = micrometres(wish.p_ST);
  return request;
}

BusRobot::BusRobot(const transport::Participant& bus, std::uint64_t config_tag)
    : measurements_(bus),
      decisions_(bus),
      replies_(bus),
      requests_(bus),
      heartbeat_(bus, Process::Navigation, config_tag) {
  heartbeat_.health().ready = true;
}

RobotView BusRobot::view(std::int64_t now_us) {
  if (measurements_.take_newest(measurement_) > 0) measured_us_ = now_us;
  if (decisions_.take_newest(decision_) > 0) decided_us_ = now_us;
  if (replies_.take_newest(reply_) > 0) replied_us_ = now_us;
  const auto is_fresh = [&](std::int64_t since_us) { return since_us != 0 && now_us - since_us < kFresh_us; };
  RobotView robot;
  robot.heard = is_fresh(measured_us_) && is_fresh(decided_us_);
  robot.console = is_fresh(replied_us_);
  robot.mode = decision_.mode;
  robot.hazard = hazard_of(decision_);
  robot.measured = robot.heard && measurement_.laser_valid;
  robot.depth = Millimetres(measurement_.depth_um * 1e-3);
  robot.step = decision_.step;
  robot.step_done = decision_.step_done;
  robot.answered = robot.console ? reply_.proposal : 0;
  robot.planned = reply_.planned;
  robot.confirmed = reply_.confirmed;
  robot.steps = reply_.steps;
  robot.why = reply_.why;
  return robot;
}

void BusRobot::tell(const Wish& wish, std::int64_t now_us) {
  heartbeat_.beat(now_us);
  NavigationRequest request = request_of(wish);
  request.seq = request_.seq;
  if (request == request_ && now_us - sent_us_ < kSendEvery_us) return;
  ++request.seq;
  requests_.write(request);
  request_ = request;
  sent_us_ = now_us;
}

}  // namespace biopsy::igtl
