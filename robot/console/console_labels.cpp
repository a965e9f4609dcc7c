#include "robot/console/console_labels.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdlib>

#include "safety/types/hazards.hpp"
#include "safety/types/limits.hpp"

namespace biopsy::robot {
namespace {

using console::Severity;
using console::events::Alarm;
using safety::Hazard;

struct Message {
  const char *what, *robot_did, *to_do;
};

constexpr std::array<Message, 10> kRefusals{{
    {"Another page controls the robot.", "Nothing moved.",
     "Use that page, or close it and take control here."},
    {"No series is open.", "Nothing moved.", "Open a series first."},
    {"The point was refused.", "The plan stays as it was.", "Click it again on the series that is shown."},
    {"The needle is in use.", "The plan stays as it was.", "Retract first."},
    {"The plan has changed since it was shown.", "Nothing was confirmed.",
     "Look at the new plan and confirm that."},
    {"There is no plan.", "Nothing moved.", "Set entry and target."},
    {"This is not possible now.", "Nothing moved.", "See the reason beside the button."},
    {"This press is over.", "Needle held.", "Release the button and press it again."},
    {"Only the key on the device does this.", "Nothing moved.", "Turn the key on the device."},
    {"The message is malformed.", "Nothing moved.", "Load the page again."},
}};

// Without the identifier, which is for the safety case.
std::string sentence(Hazard hazard, const CycleRecord& tick) {
  std::string text = hazard_text(hazard, tick.panel_unread_ms);
  if (text.starts_with("H-")) text.erase(0, 5);
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text + ".";
}

std::string code_of(Hazard hazard) {
  // Hazards that came later have the numbers after those that were there: a code keeps its meaning.
  const int place = static_cast<int>(hazard);
  if (hazard == Hazard::InterlockStuck) return "E-233";
  if (hazard == Hazard::PanelUntested) return "E-234";
  return fmt::format("E-{}",
                     200 + place - (hazard > Hazard::InterlockStuck) - (hazard > Hazard::PanelUntested));
}

Alarm alarm(Severity severity, std::string code, std::string what, std::string robot_did, std::string to_do) {
  return {severity, std::move(code), std::move(what), std::move(robot_did), std::move(to_do)};
}

const char* what_to_do(Hazard hazard) {
  switch (hazard) {
    case Hazard::PatientMotion:
      return "Retract, take a new image and plan anew.";
    case Hazard::PanelUntested:
      return "Press the emergency stop, release it, then turn the reset key: once in a session.";
    case Hazard::InterlockStuck:
      return "Do not use this stage: have the interlock's relay and its timers repaired.";
    case Hazard::StepDepth:
      return "Release, look at the image, then press again or Retract.";
    case Hazard::EStop:
    case Hazard::EStopDisagrees:
      return "Release it if it is pressed, find out why it was pressed or unread, then Reset.";
    case Hazard::PlanUnconfirmed:
    case Hazard::PlanChanged:
      return "Confirm the plan and tick what was checked; of a real stage a second person runs `biopsy "
             "confirm`.";
    case Hazard::LogBacklog:
      return "Check the disk of the log.";
    default:
      return "Look at the needle, then Retract.";
  }
}

const char* what_to_do_stopped(Hazard hazard) {
  switch (hazard) {
    case Hazard::EStop:
    case Hazard::EStopDisagrees:
    case Hazard::InterlockStuck:
      return what_to_do(hazard);
    case Hazard::LogBacklog:
      return "Check the disk of the log, then Reset.";
    default:
      return "Look at the needle, then Reset.";
  }
}

}  // namespace

console::events::Answer refusal(std::uint32_t id, Refused reason, const std::string& why) {
  const auto number = static_cast<std::size_t>(reason);
  const Message& message = kRefusals[number];
  const std::string what = why.empty() ? message.what : fmt::format("{} ({})", message.what, why);
  return {id, false, fmt::format("E-{}", 101 + number), what, message.robot_did, message.to_do};
}

bool waits_for_plan(Hazard worst) {
  return worst == Hazard::PlanChanged || worst == Hazard::PlanUnconfirmed || worst == Hazard::PlanImplausible;
}

std::vector<Alarm> alarms_of(const CycleRecord& tick, std::int32_t shown_um, bool stopped_by_operator) {
  const safety::SupervisorOutput& supervisor = tick.supervisor;
  const Hazard reason = supervisor.reason;
  std::vector<Alarm> alarms;
  switch (supervisor.permit.mode) {
    case Mode::Lock:
      alarms.push_back(alarm(Severity::Alarm, code_of(reason), sentence(reason, tick),
                             "High voltage off and locked.", "Do not use the robot. Call service."));
      break;
    case Mode::Trip:
      if (reason == Hazard::None)
        alarms.push_back(alarm(
            Severity::Alarm, "E-120", stopped_by_operator ? "STOP was pressed." : "A stop was requested.",
            "High voltage off: nothing holds the needle.", "Look at the needle, then Reset."));
      else
        alarms.push_back(alarm(Severity::Alarm, code_of(reason), sentence(reason, tick),
                               "High voltage off: nothing holds the needle.", what_to_do_stopped(reason)));
      break;
    case Mode::Retract:
      if (reason != Hazard::None)
        alarms.push_back(alarm(Severity::Warning, code_of(reason), sentence(reason, tick),
                               "The needle is being retracted.", "Wait until it is back."));
      break;
    case Mode::Hold:
      // What is there now, and what ended the motion.
      for (const Hazard hazard : {supervisor.worst, reason})
        if (hazard != Hazard::None && (alarms.empty() || supervisor.worst != reason))
          alarms.push_back(alarm(Severity::Warning, code_of(hazard), sentence(hazard, tick), "Needle held.",
                                 what_to_do(hazard)));
      break;
    case Mode::Boot:
    case Mode::Safe:
      // While only the plan is missing, the step rail shows it.
      if (supervisor.worst != Hazard::None && !waits_for_plan(supervisor.worst))
        alarms.push_back(alarm(Severity::Notice, code_of(supervisor.worst), sentence(supervisor.worst, tick),
                               "Not ready.", what_to_do(supervisor.worst)));
      else if (std::abs(shown_um) > limits::kBack_um && tick.measurement.laser_valid)
        alarms.push_back(alarm(Severity::Notice, "E-123", "The needle is not where it waits.",
                               fmt::format("Not ready: it is at {:.1f} mm.", shown_um * 1e-3),
                               "Draw the stage back along its guide by hand."));
      break;
    case Mode::Ready:
    case Mode::Armed:
    case Mode::Active:
      break;
  }
  return alarms;
}

Alarm standing_stop_alarm() {
  return alarm(Severity::Alarm, "E-122", "STOP was pressed.", "Not ready: it cannot be armed.",
               "Reset, once it is clear why it was pressed.");
}

Alarm silence_alarm() {
  return alarm(Severity::Alarm, "E-121", "The robot is silent.",
               "By itself it holds the needle, then takes the voltage off; this page cannot see it.",
               "Look at the needle. Use the hardware E-stop if it must come back now.");
}

Alarm proposal_notice() {
  return alarm(Severity::Notice, "E-125", "Entry and target are those of the navigation program.",
               "Nothing moved.", "Look at both points on the image, then confirm the plan.");
}

Alarm motion_notice() {
  return alarm(Severity::Notice, "E-126", "The navigation program asks for the insertion.",
               "Nothing moves by itself.", "Hold Insert, or Stop.");
}

Alarm navigation_stop_notice() {
  return alarm(Severity::Notice, "E-127", "The navigation program stops the robot.",
               "It cannot be armed until that program takes its stop back.", "Look at the needle.");
}

}  // namespace biopsy::robot
