#include "robot/igtl/protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "robot/igtl/codec.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::igtl {
namespace {

constexpr std::array<std::string_view, 8> kPhases{"START_UP",       "PLANNING", "CALIBRATION", "TARGETING",
                                                  "MOVE_TO_TARGET", "MANUAL",   "STOP",        "EMERGENCY"};
constexpr std::string_view kCurrentStatus = "CURRENT_STATUS", kCurrentPosition = "CURRENT_POSITION";
// A client waits for 10 s.
constexpr std::int64_t kBootMax_us = 9'000'000, kStopMax_us = 1'000'000, kPlanMax_us = 9'000'000;
constexpr std::int64_t kStopAtLeast_us = 200'000;  // longer than any view of the robot is old
constexpr std::int64_t kPositionEvery_us = 100'000, kPatientMax_us = 500'000;
constexpr std::size_t kEchoMax = 256;
constexpr std::uint16_t kAscii = 3, kUtf8 = 106;  // MIBenum; a command is the same bytes in both

// "ACK_0001" of "CMD_0001".
std::string acknowledged(const std::string& device) {
  return "ACK_" + device.substr(4);
}

bool is_driven(const RobotView& robot) {
  return safety::hv_permitted(robot.mode);
}

bool may_insert(Mode mode) {
  return mode == Mode::Armed || mode == Mode::Active || mode == Mode::Hold;
}

// Without what some programs send behind it.
std::string_view word_of(const Text& text) {
  constexpr std::string_view kBehind{"\0 \t\r\n", 5};
  const std::string_view all = text.text;
  return all.substr(0, all.find_last_not_of(kBehind) + 1);
}

// What a client sent comes back to it in a STATUS, which is US-ASCII and ends at a NUL.
std::string printable(std::string_view text) {
  std::string kept(text);
  std::ranges::replace_if(
      kept, [](char letter) { return letter < 0x20 || letter > 0x7E; }, '?');
  return kept;
}

std::string with_reason(std::string text, const std::string& reason) {
  return reason.empty() ? text : text + ": " + reason;
}

}  // namespace

std::string_view name_of(Phase phase) {
  return kPhases[static_cast<std::size_t>(phase)];
}

std::optional<Phase> phase_of(const Text& text) {
  const auto found = std::ranges::find(kPhases, word_of(text));
  if (found == kPhases.end()) return std::nullopt;
  return static_cast<Phase>(found - kPhases.begin());
}

void RobotProtocol::status(std::string_view device, StatusCode code, const std::string& text,
                           std::string_view name) {
  out_.push_back(
      {std::string(device), Status{code, printable(name.substr(0, kName_bytes)), printable(text)}});
}

RobotProtocol::Messages RobotProtocol::receive(const Message& message, const RobotView& robot,
                                               std::int64_t now_us) {
  const auto illegal = [&](const std::string& why) {
    status(kCurrentStatus, StatusCode::IllegalInstruction, why, message.device);
  };
  overtaken_.clear();
  if (const auto* text = std::get_if<Text>(&message.body)) {
    on_text(message, *text, robot, now_us);
  } else if (const auto* transform = std::get_if<Transform>(&message.body)) {
    on_transform(message.device, *transform, robot, now_us);
  } else if (const auto* query = std::get_if<Query>(&message.body)) {
    if (*query == Query::Transform && message.device == target_name())
      target_pose();
    else if (*query == Query::Transform)
      position(robot);
    else
      status(kCurrentStatus, manual_ ? StatusCode::ManualMode : StatusCode::Ok, place_text(robot),
             name_of(phase_));
  } else if (const auto* other = std::get_if<Unusable>(&message.body)) {
    illegal(fmt::format("{}: {}", other->type, other->why));
  } else if (std::holds_alternative<Image>(message.body)) {
    illegal("images are not taken here");
  }  // a STATUS is not answered: two robots would answer each other for ever
  update_stop(robot, now_us);
  return std::exchange(out_, {});
}

void RobotProtocol::on_text(const Message& message, const Text& text, const RobotView& robot,
                            std::int64_t now_us) {
  const bool asks_position = word_of(text) == kCurrentPosition || message.device == kCurrentPosition;
  if (dialect_ == Dialect::Of2021 && asks_position) return position(robot);
  const auto illegal = [&](const std::string& why) {
    status(kCurrentStatus, StatusCode::IllegalInstruction, why, text.text);
  };
  if (!message.device.starts_with("CMD_"))
    return illegal(fmt::format("STRING({}): commands are named CMD_n", message.device));
  const std::optional<Phase> phase = phase_of(text);
  const bool readable = text.encoding == kAscii || text.encoding == kUtf8;
  if (!readable && phase != Phase::Stop && phase != Phase::Emergency)  // those are never refused
    return illegal(fmt::format("encoding {}; commands are US-ASCII, {}", text.encoding, kAscii));
  if (phase) enter(*phase, robot, now_us);
  if (text.text.size() <= kEchoMax)  // before what entering had to say
    out_.insert(out_.begin(), {acknowledged(message.device), Text{text.text}});
  if (!phase)
    illegal(fmt::format("unknown command '{}'; known are {}", text.text.substr(0, kEchoMax),
                        fmt::join(kPhases, ", ")));
}

void RobotProtocol::on_transform(const std::string& device, const Transform& transform,
                                 const RobotView& robot, std::int64_t now_us) {
  if (device == kPatientMotion) return note_patient(transform, now_us);
  const bool calibrates = device.starts_with("CLB_"), aims = device.starts_with("TGT_");
  if (!calibrates && !aims)
    return status(kCurrentStatus, StatusCode::IllegalInstruction,
                  fmt::format("TRANSFORM({}): calibrations are named CLB_n, targets TGT_n", device), device);
  out_.push_back({acknowledged(device), transform});
  if (calibrates)
    calibrate(transform, robot);
  else
    aim(transform, robot, now_us);
}

void RobotProtocol::note_patient(const Transform& transform, std::int64_t now_us) {
  const auto& c = transform.columns;
  const double moved_mm = std::hypot(c[9], c[10], c[11]);
  wish_.patient_motion = std::isfinite(moved_mm) ? Millimetres(moved_mm) : kUnknownMotion;
  patient_us_ = now_us;
}

void RobotProtocol::overtake() {
  if (const auto due = std::exchange(pending_, std::nullopt)) overtaken_ = due->what;
}

// At once where it can be. Not with just any message: an answer is to whom it is due.
void RobotProtocol::await(std::string_view what, const RobotView& robot, std::int64_t now_us) {
  pending_ = Pending{std::string(what), now_us};
  update_stop(robot, now_us);
  resolve(robot, now_us);
}

// The wish to stop is set first of all; see receive().
void RobotProtocol::enter(Phase phase, const RobotView& robot, std::int64_t now_us) {
  if (phase == Phase::Emergency) stop(StopCategory::C0Off, now_us);
  if (phase == Phase::Stop || phase == Phase::Manual) stop(StopCategory::C1Ramp, now_us);
  if (wish_.motion && phase != Phase::MoveToTarget) stop(StopCategory::C1Ramp, now_us);
  overtake();
  phase_ = phase;
  status(kCurrentStatus, StatusCode::Ok, place_text(robot), name_of(phase));
  switch (phase) {
    case Phase::Planning:
    case Phase::Calibration:
      manual_ = false;
      if (dialect_ == Dialect::Of2021) status(name_of(phase), StatusCode::Ok, place_text(robot));
      break;
    case Phase::Targeting:
      manual_ = false;
      if (calibration_)
        status(name_of(phase), StatusCode::Ok, place_text(robot));
      else
        status(name_of(phase), StatusCode::NotReady, "not calibrated: send TRANSFORM(CLB_n) in CALIBRATION");
      break;
    case Phase::MoveToTarget:
      begin_motion(robot, now_us);
      break;
    case Phase::Manual:
      manual_ = true;
      [[fallthrough]];
    case Phase::StartUp:
    case Phase::Stop:
    case Phase::Emergency:
      await(name_of(phase), robot, now_us);
      break;
  }
}

void RobotProtocol::start_up(const RobotView& robot, std::int64_t now_us) {
  const bool comes_up = !robot.heard || !robot.console || robot.mode == Mode::Boot;
  if (comes_up && now_us - pending_->since_us < kBootMax_us) return;
  pending_.reset();
  const auto refuse = [&](const std::string& why) {
    status(name_of(Phase::StartUp), StatusCode::NotReady, why);
  };
  if (!robot.heard) return refuse("the robot is silent: start it with `biopsy up --console`");
  if (!robot.console) return refuse("no console answers: start the robot with `biopsy up --console`");
  if (robot.mode == Mode::Trip || robot.mode == Mode::Lock || robot.mode == Mode::Boot)
    return refuse(with_reason(fmt::format("the robot is in {}", safety::name_of(robot.mode)), robot.hazard));
  if (is_driven(robot)) return refuse("the needle is in use");
  started_ = true;
  manual_ = false;
  calibration_.reset();
  target_.reset();
  wish_.proposal = 0;
  status(name_of(Phase::StartUp), StatusCode::Ok, place_text(robot));
}

void RobotProtocol::calibrate(const Transform& transform, const RobotView& robot) {
  const auto refuse = [&](StatusCode code, const std::string& why) {
    status(name_of(Phase::Calibration), code, why);
  };
  if (phase_ != Phase::Calibration)
    return refuse(StatusCode::NotReady, "send STRING(CMD_n, CALIBRATION) first");
  if (is_driven(robot)) return refuse(StatusCode::NotReady, "the needle is in use");
  const auto given = calibration_of(transform);
  if (const auto* refused = std::get_if<Refused>(&given))
    return refuse(StatusCode::ConfigError, refused->why);
  calibration_ = std::get<RigidTransform>(given);
  target_.reset();
  wish_.proposal = 0;
  status(name_of(Phase::Calibration), StatusCode::Ok, "robot to scanner taken over");
}

void RobotProtocol::aim(const Transform& transform, const RobotView& robot, std::int64_t now_us) {
  const auto refuse = [&](StatusCode code, const std::string& why) { status(kTarget, code, why); };
  if (phase_ != Phase::Targeting) return refuse(StatusCode::NotReady, "send STRING(CMD_n, TARGETING) first");
  overtake();
  if (!calibration_) return refuse(StatusCode::NotReady, "not calibrated");
  if (is_driven(robot)) return refuse(StatusCode::NotReady, "the needle is in use");
  target_.reset();
  wish_.proposal = 0;
  const auto found = reach(*calibration_, transform);
  if (const auto* refused = std::get_if<Refused>(&found))
    return refuse(StatusCode::ConfigError, refused->why);
  target_ = std::get<Reachable>(found);
  wish_.X_SR = *calibration_;
  wish_.p_ST = target_->p_ST;
  if (!target_->is_at_entry()) wish_.proposal = ++proposals_;
  await(kTarget, robot, now_us);
}

void RobotProtocol::resolve_target(const RobotView& robot, std::int64_t now_us) {
  const bool asked = wish_.proposal != 0, answered = robot.answered == wish_.proposal;
  if (asked && !answered && now_us - pending_->since_us < kPlanMax_us) return;
  pending_.reset();
  if (asked && (!answered || !robot.planned)) {
    target_.reset();
    wish_.proposal = 0;
    if (!answered)
      return status(kTarget, StatusCode::Timeout, "no console answers: nobody can confirm a plan");
    return status(kTarget, StatusCode::ConfigError, robot.why);
  }
  const std::string left = asked ? "confirm the plan at the console" : "the tip is there";
  status(kTarget, StatusCode::Ok,
         fmt::format("{:.2f} mm deep, {:.2f} mm off the axis; {}", target_->depth.value,
                     target_->axis_offset.value, left));
  target_pose();
}

std::string_view RobotProtocol::target_name() const {
  return dialect_ == Dialect::Of2013 ? kTarget : "REACHABLE_TARGET";
}

void RobotProtocol::target_pose() {
  if (!calibration_ || !target_)
    return status(target_name(), StatusCode::NotReady,
                  !calibration_ ? "not calibrated" : "no target was accepted");
  out_.push_back({std::string(target_name()), tip_at(*calibration_, target_->depth)});
}

bool RobotProtocol::is_at_target(const RobotView& robot) const {
  return robot.measured && std::abs(robot.depth.value - target_->depth.value) <= kAtTarget.value;
}

// The first of these that applies is told.
std::string RobotProtocol::why_no_motion(const RobotView& robot) const {
  if (!robot.heard) return "the robot is silent";
  if (!started_) return "send STRING(CMD_n, START_UP) first";
  if (manual_) return "MANUAL: high voltage is locked out; send TARGETING to leave it";
  if (!calibration_) return "not calibrated";
  if (!target_ || pending_) return "no target was accepted";
  if (robot.mode == Mode::Trip || robot.mode == Mode::Lock)
    return with_reason(fmt::format("the robot is in {}: it must be reset and armed on the device",
                                   safety::name_of(robot.mode)),
                       robot.hazard);
  if (needs_arming_) return "stopped: the robot must be armed on the device again";
  if (is_at_target(robot)) return {};
  if (wish_.proposal == 0) return "the needle is in: it must be withdrawn at the console";
  if (!robot.console) return "no console answers";
  if (robot.answered != wish_.proposal || !robot.confirmed) return "the plan is not confirmed at the console";
  if (!may_insert(robot.mode)) return with_reason("not armed on the device", robot.why);
  return {};
}

void RobotProtocol::begin_motion(const RobotView& robot, std::int64_t now_us) {
  if (const std::string why = why_no_motion(robot); !why.empty()) {
    if (wish_.motion)
      stop(StopCategory::C1Ramp, now_us);  // of an earlier command: who is refused expects none
    return status(name_of(Phase::MoveToTarget), StatusCode::NotReady, why);
  }
  if (dialect_ == Dialect::Of2021)
    status(name_of(Phase::MoveToTarget), StatusCode::Ok, "a person holds the button at the console");
  wish_.motion = !is_at_target(robot);
  moved_ = moved_ || wish_.motion;
  position(robot);
  position_us_ = now_us;
  await(name_of(Phase::MoveToTarget), robot, now_us);
}

void RobotProtocol::end_motion(StatusCode code, const std::string& text, const RobotView& robot) {
  pending_.reset();
  wish_.motion = false;
  if (code != StatusCode::Ok || dialect_ == Dialect::Of2013) status(name_of(Phase::MoveToTarget), code, text);
  position(robot);
}

void RobotProtocol::resolve_motion(const RobotView& robot, std::int64_t now_us) {
  if (!wish_.motion) return end_motion(StatusCode::Ok, place_text(robot), robot);  // was there before
  const bool last = robot.steps > 0 && robot.step + 1 >= robot.steps;
  if (!robot.heard) return end_motion(StatusCode::HardwareFailure, "the robot is silent", robot);
  if (robot.mode == Mode::Hold && robot.step_done && last)
    return end_motion(StatusCode::Ok, place_text(robot), robot);
  if (!may_insert(robot.mode)) {
    const bool tripped = robot.mode == Mode::Trip || robot.mode == Mode::Lock;
    return end_motion(
        tripped ? StatusCode::Panic : StatusCode::NotReady,
        with_reason(fmt::format("stopped, the robot is in {}", safety::name_of(robot.mode)), robot.hazard),
        robot);
  }
  if (now_us - position_us_ < kPositionEvery_us) return;
  position_us_ = now_us;
  position(robot);
}

void RobotProtocol::stop(StopCategory category, std::int64_t now_us) {
  stop_ = std::max(stop_, category);
  stopped_us_ = now_us;
  wish_.motion = false;
  wish_.stop = std::max(wish_.stop, stop_);
  needs_arming_ = true;
  seen_off_ = false;
}

void RobotProtocol::update_stop(const RobotView& robot, std::int64_t now_us) {
  const bool off = robot.heard && !is_driven(robot);
  if (off && now_us - stopped_us_ >= kStopAtLeast_us) stop_ = StopCategory::None;
  wish_.stop = std::max(stop_, manual_ ? StopCategory::C1Ramp : StopCategory::None);
  if (off) moved_ = false, seen_off_ = seen_off_ || stop_ == StopCategory::None;
  if (seen_off_ && robot.heard && robot.mode == Mode::Armed) needs_arming_ = false;
}

void RobotProtocol::resolve(const RobotView& robot, std::int64_t now_us) {
  if (!pending_) return;
  if (pending_->what == kTarget) return resolve_target(robot, now_us);
  const std::string what = pending_->what;
  if (what == name_of(Phase::StartUp)) return start_up(robot, now_us);
  if (what == name_of(Phase::MoveToTarget)) return resolve_motion(robot, now_us);
  const bool ramps = robot.mode == Mode::Retract && phase_ == Phase::Stop;
  const bool stopped = robot.heard && (!is_driven(robot) || ramps);
  if (!stopped && now_us - pending_->since_us < kStopMax_us) return;
  pending_.reset();
  if (stopped)
    status(what, StatusCode::Ok, place_text(robot));
  else
    status(what, StatusCode::Timeout, "the robot does not confirm it: use the emergency stop on the device");
}

RobotProtocol::Messages RobotProtocol::tick(const RobotView& robot, std::int64_t now_us) {
  if (wish_.patient_motion && now_us - patient_us_ > kPatientMax_us) wish_.patient_motion = kUnknownMotion;
  update_stop(robot, now_us);
  resolve(robot, now_us);
  return std::exchange(out_, {});
}

void RobotProtocol::link_lost(const RobotView& robot, std::int64_t now_us) {
  if (wish_.motion || (moved_ && is_driven(robot))) stop(StopCategory::C1Ramp, now_us);
  pending_.reset();
  update_stop(robot, now_us);
}

// In the patient, RAS; without a calibration nobody knows where that is.
void RobotProtocol::position(const RobotView& robot) {
  if (!calibration_ || !robot.heard || !robot.measured)
    return status(kCurrentPosition, StatusCode::NotReady,
                  !calibration_ ? "not calibrated" : "the needle's depth is not measured");
  out_.push_back({std::string(kCurrentPosition), tip_at(*calibration_, robot.depth)});
}

std::string RobotProtocol::place_text(const RobotView& robot) const {
  if (!robot.heard) return "the robot is silent";
  std::string text(safety::name_of(robot.mode));
  if (robot.measured) text += fmt::format(", tip at {:.2f} mm", robot.depth.value);
  if (robot.measured && target_)
    text += fmt::format(", {:.2f} mm before the target", target_->depth.value - robot.depth.value);
  return with_reason(text, robot.hazard);
}

}  // namespace biopsy::igtl
