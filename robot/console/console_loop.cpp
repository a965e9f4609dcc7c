#include "robot/console/console_loop.hpp"

#include <fmt/format.h>

#include <fstream>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/logging/logger.hpp"
#include "robot/console/console_events.hpp"
#include "robot/console/console_labels.hpp"
#include "robot/console/server/command_from_json.hpp"
#include "robot/console/server/origin_policy.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::robot {
namespace {

using console::Client;
using console::Reliability;
namespace events = console::events;

constexpr std::int64_t kSendChanges_us = 20'000;

std::int64_t now_in_us() {
  return realtime::monotonic_ns() / 1000;
}

std::int64_t wall_ms() {
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(wall).count();
}

template <class Message>
console::SendQueue::Text text_of(const Message& message) {
  nlohmann::json json = message;
  json["type"] = Message::kType;
  return std::make_shared<const std::string>(json.dump());
}

}  // namespace

ConsoleLoop::ConsoleLoop(LiveRobot& robot, NavigationLink& navigation, PreparedCase opened,
                         const Settings& settings)
    : robot_(robot),
      navigation_(navigation),
      settings_(settings),
      session_(std::move(opened), settings.simulated, settings.folder, settings.first_token,
               [&robot](const Plan& plan, const std::array<std::uint64_t, 2>& confirmed) {
                 robot.send_plan(plan, confirmed);
               }),
      alarms_(settings.kept / "alarms.jsonl"),
      points_(settings.kept / "points.jsonl") {
  points_.restore(session_);
  // A STOP that stands is the one of before and stays acknowledged. What the robot reports later is new.
  alarms_.update(session_.alarms(), wall_ms());
  console::ServerCallbacks callbacks;
  callbacks.connected = [this](Client client) { on_connect(client); };
  callbacks.received = [this](Client client, const std::string& text) { on_message(client, text); };
  callbacks.disconnected = [this](Client client) { on_disconnect(client); };
  callbacks.document = [this](const std::string& path) { return document(path); };
  server_ = std::make_unique<console::HttpServer>(
      settings.page, settings.port, settings.token.empty() ? console::new_token() : settings.token,
      callbacks);
}

void ConsoleLoop::on_connect(Client client) {
  const std::lock_guard lock(mutex_);
  session_.connect(client);
  new_clients_.insert(client);
  sent_[client] = {};
}

void ConsoleLoop::on_disconnect(Client client) {
  const std::lock_guard lock(mutex_);
  session_.disconnect(client);
  new_clients_.erase(client);
  sent_.erase(client);
}

void ConsoleLoop::on_message(Client client, const std::string& text) {
  const std::lock_guard lock(mutex_);
  std::optional<events::Answer> answer;
  try {
    const console::commands::Any command = console::command_from_json(text);
    answer = session_.handle(client, command, now_in_us());
    const auto* seen = std::get_if<console::commands::Acknowledge>(&command);
    if (seen != nullptr && session_.is_controlled_by(client)) {
      alarms_.acknowledge(seen->newest, wall_ms());
      log_command(client, text, "done");
    }
  } catch (const console::MessageFault& fault) {
    answer = refusal(0, Refused::Malformed, fault.what());
  }
  if (!answer) return;
  if (!answer->done)
    alarms_.note({console::Severity::Notice, answer->code, answer->what, answer->robot_did, answer->to_do},
                 wall_ms());
  log_command(client, text, answer->done ? "done" : answer->code + " " + answer->what);
  server_->send(client, text_of(*answer), Reliability::Reliable);
  keep_points();
}

std::optional<console::Document> ConsoleLoop::document(const std::string& path) {
  std::filesystem::path written;
  {
    const std::lock_guard lock(mutex_);
    const ConsoleSeries& series = session_.series();
    if (path == series.file_name()) return console::Document{"application/octet-stream", series.file()};
    if (path == ConsoleSeries::kLabelsName && series.labels())
      return console::Document{"application/octet-stream", series.labels()};
    if (path != "/report.html") return std::nullopt;
    written = session_.report();
  }
  if (!std::filesystem::exists(written)) return std::nullopt;
  console::Document report{"text/html; charset=utf-8",
                           std::make_shared<const std::string>(read_file(written))};
  report.self_contained = true;
  return report;
}

// Commands to the console, done or refused; those that reached the robot are in the procedure log too.
void ConsoleLoop::log_command(Client client, const std::string& text, const std::string& answer) {
  const nlohmann::json act{{"at_ms", wall_ms()}, {"page", client}, {"asked", text}, {"answer", answer}};
  std::ofstream(settings_.folder / "console-acts.jsonl", std::ios::app)
      << act.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) << '\n';
}

// A full disk costs what a restart would have found, and nothing else.
void ConsoleLoop::keep_points() {
  try {
    points_.update(session_);
  } catch (const ConfigError& error) {
    constexpr logging::Logger log{logging::Component::Console};
    log.warning("points and STOP are not kept over a restart: {}", error.what());
  }
}

void ConsoleLoop::send_states(std::int64_t now_us) {
  for (auto& [client, sent] : sent_) {
    const events::State state = session_.state(client, now_us);
    const ShownState::Due due = sent.due(state, now_us);
    if (due == ShownState::Due::No) continue;
    server_->send(client, text_of(state),
                  due == ShownState::Due::Reliable ? Reliability::Reliable : Reliability::BestEffort);
    sent.note(state, now_us);
  }
}

// To pages that are new, and to all when there is another.
void ConsoleLoop::send_alarms() {
  alarms_.update(session_.alarms(), wall_ms());
  const bool changed = std::exchange(sent_alarms_, alarms_.version()) != alarms_.version();
  if (changed ? sent_.empty() : new_clients_.empty()) return;
  const console::SendQueue::Text text = text_of(alarms_.event());
  for (const auto& [client, sent] : sent_)
    if (changed || new_clients_.contains(client)) server_->send(client, text, Reliability::Reliable);
}

void ConsoleLoop::send_changes() {
  send_alarms();
  const bool changed = std::exchange(sent_version_, session_.version()) != session_.version();
  const std::uint32_t series_version = session_.series().version();
  if (std::exchange(sent_series_, series_version) != series_version)
    for (const auto& [client, sent] : sent_) new_clients_.insert(client);
  const auto send_all = [this](Client client) {
    if (const auto opened = session_.opened()) server_->send(client, text_of(*opened), Reliability::Reliable);
    server_->send(client, text_of(session_.planned()), Reliability::Reliable);
    for (const events::Checked& checked : session_.checked())
      server_->send(client, text_of(checked), Reliability::Reliable);
  };
  for (const Client client : new_clients_) {
    events::Welcome welcome;
    welcome.simulated = settings_.simulated;
    welcome.title = session_.prepared().given.title;
    welcome.sample = session_.prepared().given.phantom;
    welcome.session = std::to_string(settings_.first_token);
    welcome.series = session_.series().all();
    server_->send(client, text_of(welcome), Reliability::Reliable);
    if (!changed) send_all(client);
  }
  new_clients_.clear();
  if (!changed) return;
  keep_points();
  for (const auto& [client, sent] : sent_) send_all(client);
}

void ConsoleLoop::step() {
  OperatorInputs inputs;
  {
    const std::lock_guard lock(mutex_);
    const std::int64_t now_us = now_in_us();
    navigation_.answer(session_.navigate(navigation_.newest(now_us), now_us), now_us);
    inputs = session_.inputs(now_us);
  }
  const std::optional<CycleSample> cycle = robot_.tick(inputs);
  const std::int64_t now_us = now_in_us();
  const std::lock_guard lock(mutex_);
  if (cycle) {
    session_.update(*cycle, now_us);
    const Measurement& measured = cycle->record.measurement;
    const auto batch = batch_.add({static_cast<double>(measured.time_us) * 1e-3, measured.depth_um * 1e-3,
                                   cycle->setpoint.value, measured.monitor_mV * 1e-6,
                                   cycle->record.supervisor.permit.v_max_mV * 1e-6});
    if (batch) server_->send_to_all(text_of(*batch), Reliability::BestEffort);
  } else {
    session_.mark_silent();
  }
  if (cycle && ++ticks_ % (kSendChanges_us / 1000) != 0) return;
  send_changes();
  send_states(now_us);
}

}  // namespace biopsy::robot
