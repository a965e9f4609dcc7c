#include "robot/igtl/navigation_server.hpp"

#include <fmt/format.h>

#include "robot/common/logging/logger.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::igtl {
namespace {

constexpr logging::Logger kLog{logging::Component::Navigation};

std::int64_t now_in_us() {
  return realtime::monotonic_ns() / 1000;
}

// The answer that a command, calibration or target ends with; empty: the message is none of them, or one that
// is not known, and changes nothing.
std::string_view last_answer_to(const Message& message) {
  if (std::holds_alternative<Transform>(message.body)) {
    if (message.device.starts_with("TGT_")) return kTarget;
    return message.device.starts_with("CLB_") ? name_of(Phase::Calibration) : std::string_view();
  }
  const auto* text = std::get_if<Text>(&message.body);
  const std::optional<Phase> phase = text ? phase_of(*text) : std::nullopt;
  return phase && message.device.starts_with("CMD_") ? name_of(*phase) : std::string_view();
}

bool is_stop(std::string_view answer) {
  return answer == name_of(Phase::Stop) || answer == name_of(Phase::Emergency);
}

// Why `due` does not come any more, now that the same program wants `next`; empty: the answers to `next` say
// it.
std::string why_overtaken(std::string_view due, std::string_view next) {
  if (due == next) return due == kTarget ? "overtaken by the next target" : "";
  return due == name_of(Phase::MoveToTarget) ? "" : fmt::format("overtaken by {}", next);
}

bool is_position(const Message& message) {
  return std::holds_alternative<Transform>(message.body) && message.device == "CURRENT_POSITION";
}

bool is_patient_motion(const Message& message) {
  return std::holds_alternative<Transform>(message.body) && message.device == kPatientMotion;
}

}  // namespace

NavigationServer::NavigationServer(const ServerSettings& settings, Dialect dialect,
                                   const std::filesystem::path& images, RobotLink& robot)
    : server_(settings), protocol_(dialect), images_(images), robot_(robot) {}

void NavigationServer::send(Client client, const std::vector<Message>& messages) {
  for (const Message& message : messages) server_.send(client, message, is_position(message));
}

void NavigationServer::tell_stored(Client client, const std::string& device,
                                   const std::variant<std::string, Refused>& stored) {
  const auto* refused = std::get_if<Refused>(&stored);
  const std::string text = refused ? refused->why : std::get<std::string>(stored);
  kLog.info("image of client {}: {}", client, text);
  server_.send(client, {device, Status{refused ? StatusCode::ConfigError : StatusCode::Ok, "IMAGE", text}});
}

void NavigationServer::handle(Client client, Message& message, std::int64_t now_us) {
  if (auto* image = std::get_if<Image>(&message.body)) {
    if (const auto refused = images_.submit(client, message.device, std::move(*image)))
      tell_stored(client, message.device, *refused);
    return;
  }
  if (is_patient_motion(message) && patient_sensor_.value_or(client) != client)
    return server_.send(client, {"CURRENT_STATUS", Status{StatusCode::AccessDenied, message.device,
                                                          "another program measures the patient"}});
  if (is_patient_motion(message)) patient_sensor_ = client;
  const std::string_view wanted = last_answer_to(message);
  const bool commands = !wanted.empty();
  if (commands && !controller_ && !is_stop(wanted)) {  // whoever stops does not lock others out
    controller_ = client;
    server_.keep(client);
    kLog.info("client {} controls", client);
  }
  if (commands && controller_ != client && !is_stop(wanted))
    return server_.send(client, {"CURRENT_STATUS", Status{StatusCode::AccessDenied, message.device,
                                                          "another navigation program controls"}});
  const std::vector<Message> answers = protocol_.receive(message, robot_.view(now_us), now_us);
  robot_.tell(protocol_.wish(), now_us);  // a stop before its acknowledgement
  if (const std::string due = protocol_.overtaken(); !due.empty()) {
    const std::string why =
        asked_ == client ? why_overtaken(due, wanted) : "stopped by another navigation program";
    if (!why.empty())  // who waits for it learns that it does not come
      server_.send(asked_, {due, Status{StatusCode::NotReady, "", why}});
  }
  if (commands) asked_ = client;
  if (const auto* text = std::get_if<Text>(&message.body))
    kLog.info("client {}: STRING({}, {})", client, message.device, text->text.substr(0, 64));
  send(client, answers);
}

void NavigationServer::turn(std::chrono::milliseconds timeout) {
  std::vector<ServerEvent> events = server_.poll(timeout);
  const std::int64_t now_us = now_in_us();
  for (ServerEvent& event : events) {
    if (event.message) {
      handle(event.client, *event.message, now_us);
    } else {
      kLog.info("client {} has gone: {}", event.client, event.why);
      if (patient_sensor_ == event.client) patient_sensor_.reset();  // what it said grows old
      if (controller_ != event.client) continue;
      controller_.reset();
      server_.keep(std::nullopt);
      protocol_.link_lost(robot_.view(now_us), now_us);
      robot_.tell(protocol_.wish(), now_us);
    }
  }
  const std::vector<Message> answers = protocol_.tick(robot_.view(now_us), now_us);
  robot_.tell(protocol_.wish(), now_us);
  send(asked_, answers);
  for (const ImageWriter::Written& image : images_.take_written())
    tell_stored(image.client, image.device, image.result);
  server_.flush();
}

}  // namespace biopsy::igtl
