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

// What changes anything: commands and poses.
bool commands_robot(const Message& message) {
  return std::holds_alternative<Transform>(message.body) ||
         (std::holds_alternative<Text>(message.body) && message.device.starts_with("CMD_"));
}

bool stops_robot(const Message& message) {
  const auto* text = std::get_if<Text>(&message.body);
  if (text == nullptr) return false;
  const std::optional<Phase> phase = phase_of(*text);
  return phase == Phase::Stop || phase == Phase::Emergency;
}

bool is_position(const Message& message) {
  return std::holds_alternative<Transform>(message.body) && message.device == "CURRENT_POSITION";
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
  const bool commands = commands_robot(message);
  if (commands && !controller_) {
    controller_ = client;
    kLog.info("client {} controls", client);
  }
  if (commands && controller_ != client && !stops_robot(message))
    return server_.send(client, {"CURRENT_STATUS", Status{StatusCode::AccessDenied, message.device,
                                                          "another navigation program controls"}});
  const std::string due = protocol_.due();
  const std::vector<Message> answers = protocol_.receive(message, robot_.view(now_us), now_us);
  robot_.tell(protocol_.wish(), now_us);             // a stop before its acknowledgement
  if (commands && asked_ != client && !due.empty())  // who waits for it learns why it does not come
    server_.send(asked_, {due, Status{StatusCode::NotReady, "", "stopped by another navigation program"}});
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
      if (controller_ != event.client) continue;
      controller_.reset();
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
