#include "robot/console/console_loop.hpp"

#include <fmt/format.h>

#include <fstream>

#include "robot/common/files/file.hpp"
#include "robot/console/console_events.hpp"
#include "robot/console/console_labels.hpp"
#include "robot/console/server/command_from_json.hpp"
#include "robot/console/server/origin_policy.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::robot {
namespace {

using console::Client;
using console::Worth;
namespace events = console::events;

constexpr std::int64_t kLook_us = 20'000, kStates_us = 100'000;

std::int64_t now_in_us() {
  return realtime::monotonic_ns() / 1000;
}

template <class Message>
console::Outbox::Text text_of(const Message& message) {
  nlohmann::json json = message;
  json["type"] = Message::kType;
  return std::make_shared<const std::string>(json.dump());
}

// A State without what changes in every tick: where this differs, the page must hear of it.
std::string lasting(events::State state) {
  state.seq = 0;
  state.depth = state.drive = state.hold_left = state.armed_left = state.ticks_left = state.arm_held = 0.0;
  return nlohmann::json(state).dump();
}

}  // namespace

ConsoleLoop::ConsoleLoop(LiveRobot& robot, PreparedCase opened, const Settings& settings)
    : robot_(robot),
      settings_(settings),
      session_(std::move(opened), settings.simulated, settings.folder, settings.first_token,
               [&robot](const Plan& plan, const std::array<std::uint64_t, 2>& confirmed) {
                 robot.send_plan(plan, confirmed);
               }) {
  console::WebEvents web;
  web.came = [this](Client client) { came(client); };
  web.said = [this](Client client, const std::string& text) { said(client, text); };
  web.left = [this](Client client) { left(client); };
  web.document = [this](const std::string& path) { return document(path); };
  server_ = std::make_unique<console::HttpServer>(settings.page, settings.port, console::new_token(), web);
}

void ConsoleLoop::came(Client client) {
  const std::lock_guard lock(mutex_);
  session_.came(client);
  newcomers_.insert(client);
  told_[client].clear();
}

void ConsoleLoop::left(Client client) {
  const std::lock_guard lock(mutex_);
  session_.left(client);
  newcomers_.erase(client);
  told_.erase(client);
}

void ConsoleLoop::said(Client client, const std::string& text) {
  const std::lock_guard lock(mutex_);
  std::optional<events::Answer> answer;
  try {
    answer = session_.ask(client, console::command_from_json(text), now_in_us());
  } catch (const console::MessageFault& fault) {
    answer = refusal(0, Refused::NotUnderstood, fault.what());
  }
  if (!answer) return;
  note_act(client, text, answer->done ? "done" : answer->code + " " + answer->what);
  server_->send(client, text_of(*answer), Worth::MustArrive);
}

std::optional<console::Document> ConsoleLoop::document(const std::string& path) {
  std::filesystem::path written;
  {
    const std::lock_guard lock(mutex_);
    const ConsoleSeries& series = session_.series();
    if (path == series.file_name()) return console::Document{"application/octet-stream", series.file()};
    if (path != "/report.html") return std::nullopt;
    written = session_.report();
  }
  if (!std::filesystem::exists(written)) return std::nullopt;
  console::Document report{"text/html; charset=utf-8",
                           std::make_shared<const std::string>(read_file(written))};
  report.self_contained = true;
  return report;
}

// Beside the procedure log, which holds what reached the robot: what was asked of the console, done or
// refused.
void ConsoleLoop::note_act(Client client, const std::string& text, const std::string& answer) {
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  const nlohmann::json act{{"at_ms", std::chrono::duration_cast<std::chrono::milliseconds>(wall).count()},
                           {"page", client},
                           {"asked", text},
                           {"answer", answer}};
  std::ofstream(settings_.folder / "console-acts.jsonl", std::ios::app)
      << act.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) << '\n';
}

void ConsoleLoop::tell_states(std::int64_t now_us) {
  const bool due = now_us - states_us_ >= kStates_us;
  if (due) states_us_ = now_us;
  for (auto& [client, told] : told_) {
    const events::State state = session_.state(client, now_us);
    std::string now = lasting(state);
    const bool news = now != told;
    if (news || due) server_->send(client, text_of(state), news ? Worth::MustArrive : Worth::MayBeLost);
    if (news) told = std::move(now);
  }
}

void ConsoleLoop::tell_news() {
  const bool changed = std::exchange(told_version_, session_.version()) != session_.version();
  const std::uint32_t series_version = session_.series().version();
  if (std::exchange(told_series_, series_version) != series_version)
    for (const auto& [client, told] : told_) newcomers_.insert(client);
  const auto tell_all = [this](Client client) {
    if (const auto opened = session_.opened()) server_->send(client, text_of(*opened), Worth::MustArrive);
    server_->send(client, text_of(session_.planned()), Worth::MustArrive);
    for (const events::Checked& checked : session_.checked())
      server_->send(client, text_of(checked), Worth::MustArrive);
  };
  for (const Client client : newcomers_) {
    events::Welcome welcome;
    welcome.simulated = settings_.simulated;
    welcome.title = session_.prepared().given.title;
    welcome.sample = session_.prepared().given.phantom;
    welcome.series = session_.series().all();
    server_->send(client, text_of(welcome), Worth::MustArrive);
    if (!changed) tell_all(client);
  }
  newcomers_.clear();
  if (!changed) return;
  for (const auto& [client, told] : told_) tell_all(client);
}

void ConsoleLoop::turn() {
  OperatorInputs inputs;
  {
    const std::lock_guard lock(mutex_);
    inputs = session_.inputs(now_in_us());
  }
  const std::optional<CycleSample> cycle = robot_.tick(inputs);
  const std::int64_t now_us = now_in_us();
  const std::lock_guard lock(mutex_);
  if (cycle) {
    session_.see(*cycle, now_us);
    const Measurement& measured = cycle->record.measurement;
    const auto batch = batch_.add({static_cast<double>(measured.time_us) * 1e-3, measured.depth_um * 1e-3,
                                   cycle->setpoint.value, measured.monitor_mV * 1e-6,
                                   cycle->record.supervisor.permit.v_max_mV * 1e-6});
    if (batch) server_->send_to_all(text_of(*batch), Worth::MayBeLost);
  } else {
    session_.miss();
  }
  if (cycle && ++ticks_ % (kLook_us / 1000) != 0) return;
  tell_news();
  tell_states(now_us);
}

}  // namespace biopsy::robot
