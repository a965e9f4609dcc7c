// The robot's side of the OpenIGTLink protocol for MRI robots, without sockets and bus: messages and what is
// known of the robot in, messages and wishes out. Dialect 2013: NA-MIC wiki, "ProstateBRP OpenIGTLink
// Communication June 2013"; dialect 2021: the robots of ProstateBRP since 2021.
//
// A wish moves nothing. Points are planned, shown and confirmed at the console; motion needs the arm key on
// the device and the button that a person holds there; the supervisor decides.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robot/igtl/message.hpp"
#include "robot/igtl/reach.hpp"
#include "robot/msg/fixed_messages.hpp"

namespace biopsy::igtl {

enum class Dialect : std::uint8_t { Of2013, Of2021 };

enum class Phase : std::uint8_t {
  StartUp,
  Planning,
  Calibration,
  Targeting,
  MoveToTarget,
  Manual,
  Stop,
  Emergency,
};
// As it is sent: "MOVE_TO_TARGET".
std::string_view name_of(Phase phase);
constexpr std::string_view kTarget = "TARGET";  // the status that a TRANSFORM(TGT_n) ends with
// The device of a TRANSFORM whose translation is how far the tissue at the needle is from where the planning
// image shows it, mm. It streams and is not answered.
constexpr std::string_view kPatientMotion = "PATIENT_MOTION";
// The phase that a command asks for; what some programs send behind it, a NUL or the end of a line, is not
// part of it.
std::optional<Phase> phase_of(const Text& text);

// What is known of the robot. Default-constructed: nothing.
struct RobotView {
  bool heard = false;    // supervisor and stage, newly
  bool console = false;  // answers
  Mode mode = Mode::Boot;
  std::string hazard;  // why it is not ready or was stopped; empty: nothing
  bool measured = false;
  Millimetres depth;  // of the tip
  std::uint32_t step = 0;
  bool step_done = false;
  // What the console says of the newest proposal
  std::uint32_t answered = 0;  // its number; 0: none
  bool planned = false;        // there is a plan to it
  bool confirmed = false;      // by a person
  std::uint32_t steps = 0;
  std::string why;  // there is no plan, or it cannot be armed
};

// What the navigation program wishes of the robot, at any time.
constexpr Millimetres kUnknownMotion{std::numeric_limits<double>::infinity()};
struct Wish {
  StopCategory stop = StopCategory::None;
  bool motion = false;
  std::uint32_t proposal = 0;  // rises with each; 0: none
  RigidTransform X_SR = RigidTransform::Identity();
  Point p_ST = Point::Zero();
  // By TRANSFORM(PATIENT_MOTION): none came yet, or how far the patient moved; infinite: it comes no more.
  std::optional<Millimetres> patient_motion = {};
};

class RobotProtocol {
 public:
  using Messages = std::vector<Message>;

  explicit RobotProtocol(Dialect dialect) : dialect_(dialect) {}

  // Answers in their order. The wish is up to date when it returns and goes to the robot before the answers
  // do: it stops before it acknowledges.
  Messages receive(const Message& message, const RobotView& robot, std::int64_t now_us);
  // Call often: what is sent by itself, and answers that had to wait for the robot, to whoever commanded
  // last.
  Messages tick(const RobotView& robot, std::int64_t now_us);
  // The connection ended, in whatever way: a STOP where it had asked for motion. Calibration and target stay,
  // for a navigation program that comes back.
  void link_lost(const RobotView& robot, std::int64_t now_us);

  const Wish& wish() const { return wish_; }
  // Name of the status that was due for an earlier command or target and that the last message received put
  // an end to; empty: none.
  const std::string& overtaken() const { return overtaken_; }

 private:
  struct Pending {
    std::string what;  // name of the status that is due
    std::int64_t since_us = 0;
  };

  void on_text(const Message& message, const Text& text, const RobotView& robot, std::int64_t now_us);
  void on_transform(const std::string& device, const Transform& transform, const RobotView& robot,
                    std::int64_t now_us);
  void enter(Phase phase, const RobotView& robot, std::int64_t now_us);
  void start_up(const RobotView& robot, std::int64_t now_us);
  void note_patient(const Transform& transform, std::int64_t now_us);
  void overtake();
  void await(std::string_view what, const RobotView& robot, std::int64_t now_us);
  void calibrate(const Transform& transform, const RobotView& robot);
  void aim(const Transform& transform, const RobotView& robot, std::int64_t now_us);
  void begin_motion(const RobotView& robot, std::int64_t now_us);
  std::string why_no_motion(const RobotView& robot) const;
  std::string_view target_name() const;
  void target_pose();
  bool is_at_target(const RobotView& robot) const;
  void stop(StopCategory category, std::int64_t now_us);
  void update_stop(const RobotView& robot, std::int64_t now_us);
  void resolve(const RobotView& robot, std::int64_t now_us);
  void resolve_target(const RobotView& robot, std::int64_t now_us);
  void resolve_motion(const RobotView& robot, std::int64_t now_us);
  void end_motion(StatusCode code, const std::string& text, const RobotView& robot);
  void status(std::string_view device, StatusCode code, const std::string& text, std::string_view name = {});
  void position(const RobotView& robot);
  std::string place_text(const RobotView& robot) const;

  Dialect dialect_;
  Phase phase_ = Phase::StartUp;
  bool started_ = false, manual_ = false;
  std::optional<RigidTransform> calibration_;
  std::optional<Reachable> target_;
  std::uint32_t proposals_ = 0;
  std::optional<Pending> pending_;
  std::string overtaken_;
  Wish wish_;
  StopCategory stop_ = StopCategory::None;  // until high voltage is seen off
  std::int64_t stopped_us_ = 0, position_us_ = 0, patient_us_ = 0;
  bool moved_ = false;  // under the present high voltage
  bool needs_arming_ = false, seen_off_ = false;
  Messages out_;
};

}  // namespace biopsy::igtl
