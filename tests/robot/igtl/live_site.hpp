// Claims' robot: the real processes, secured, with biopsy-igtl among them, a person at the console's session,
// and a navigation program's end of a connection. Nothing between them is replaced.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <thread>

#include "robot/common/files/file.hpp"
#include "robot/console/navigation_link.hpp"
#include "robot/console/operator_session.hpp"
#include "robot/igtl/bus_robot.hpp"
#include "robot/live/live_process.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "robot/live/session/live_session.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/transitions.hpp"
#include "tests/robot/igtl/test_client.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {

using namespace std::chrono_literals;
namespace commands = console::commands;
constexpr std::uint32_t kDomain = 96;  // and the next: of these tests alone
constexpr console::Client kPage = 1;

inline std::int64_t now_in_us() {
  return realtime::monotonic_ns() / 1000;
}

// A person who confirms what is proposed, arms, holds Insert when it is asked for, and accepts good images.
class PersonAtConsole {
 public:
  PersonAtConsole(transport::Participant& bus, const LiveSession& live, const std::filesystem::path& folder,
                  PreparedCase opened)
      : robot_(bus, live.settings().lines, live::config_tag(folder, live.settings())),
        link_(bus),
        session_(std::move(opened), true, folder / "console", 1,
                 [this](const Plan& plan, const std::array<std::uint64_t, 2>& confirmed) {
                   robot_.send_plan(plan, confirmed);
                 }) {
    session_.connect(kPage);
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) step();
    });
  }

  std::atomic<bool> arms = true, inserts = true, resets = false;
  std::atomic<Mode> mode = Mode::Boot;
  std::atomic<std::int64_t> drive_mV = 0;
  std::atomic<safety::Hazard> hazard =
      safety::Hazard::None;  // of the last trip, ramp or hold for one, or present where a mode was left
  std::atomic<std::int32_t> panel_unread_ms = 0;  // then, as in Decision
  std::uint64_t lost() const { return robot_.lost(); }
  std::array<Health, kCount<Process>> health() const { return robot_.health(); }
  std::atomic<int> accepted = 0;  // images
  std::atomic<int> looks = 0;     // every 20 ms
  // What the console says of the newest image.
  console::events::Checked check() const {
    const std::lock_guard guard(mutex_);
    return check_;
  }

 private:
  void step() {
    const std::int64_t now_us = now_in_us();
    link_.answer(session_.navigate(link_.newest(now_us), now_us), now_us);
    const auto cycle = robot_.tick(session_.inputs(now_us));
    if (!cycle) return session_.mark_silent();
    session_.update(*cycle, now_in_us());
    const safety::SupervisorOutput& supervisor = cycle->record.supervisor;
    const bool left = mode.exchange(supervisor.permit.mode) != supervisor.permit.mode;
    drive_mV = cycle->record.drive_mV;
    const safety::Hazard reason =
        supervisor.reason == safety::Hazard::None && left ? supervisor.worst : supervisor.reason;
    if (reason != safety::Hazard::None) hazard = reason, panel_unread_ms = cycle->record.panel_unread_ms;
    if (++ticks_ % 20 == 0) act(now_in_us());
  }
  bool ask(const commands::Any& command) {
    const auto answer = session_.handle(kPage, command, now_in_us());
    return answer && answer->done;
  }
  void hold(console::Button button, bool wanted, std::int64_t now_us) {
    const double page_ms = static_cast<double>(now_us) * 1e-3;
    if (held_ && (!wanted || !session_.inputs(now_us).press.held) && button == console::Button::Insert)
      ask(commands::Release{*held_}), held_.reset();
    if (held_ && wanted) ask(commands::Beat{*held_, page_ms});
    if (held_ || !wanted) return;
    const std::uint32_t token = session_.state(kPage, now_us).token;
    if (ask(commands::Press{1, button, token, page_ms})) held_ = token;
  }
  void act(std::int64_t now_us) {
    const auto state = session_.state(kPage, now_us);
    const auto planned = session_.planned();
    if (!planned.seal.empty() && !planned.confirmed) ask(commands::ConfirmPlan{1, planned.seal});
    for (const console::Tick tick : {console::Tick::Patient, console::Tick::Place, console::Tick::Risks})
      if (planned.confirmed && !state.ticks[static_cast<std::size_t>(tick)])
        ask(commands::SetTick{1, tick, true, planned.seal});
    if (resets && looks % 50 == 0 && state.disabled.reset.empty()) ask(commands::Reset{1});
    const bool asked = std::ranges::any_of(state.alarms, [](const auto& one) { return one.code == "E-126"; });
    if (state.disabled.arm.empty() && arms) return hold(console::Button::Arm, true, now_us);
    if (mode == Mode::Armed && held_ && state.held.empty()) held_.reset();  // of arming
    hold(console::Button::Insert, asked && inserts && state.disabled.insert.empty(), now_us);
    if (const auto checked = session_.checked(); !checked.empty()) {
      const std::lock_guard guard(mutex_);
      check_ = checked.back();
    }
    if (state.disabled.accept.empty() && ask(commands::Judge{1, state.stage, console::Judgement::Accept}))
      ++accepted;
    ++looks;
  }

  LiveRobot robot_;
  NavigationLink link_;
  OperatorSession session_;
  std::optional<std::uint32_t> held_;
  std::int64_t ticks_ = 0;
  mutable std::mutex mutex_;
  console::events::Checked check_;
  std::jthread thread_;  // last
};

struct Site {
  ScratchFolder folder;
  PreparedCase prepared;
  std::unique_ptr<LiveSession> live;
  std::unique_ptr<transport::Participant> bus;
  std::unique_ptr<PersonAtConsole> person;
  std::uint16_t port = 0;

  // `more`: options of biopsy-igtl.
  explicit Site(std::uint32_t domain, const Case& given = read_case("gap"),
                const std::vector<std::string>& more = {})
      : prepared(prepare(given, folder.path())) {
    LiveOptions options;
    options.domain = domain;
    live = std::make_unique<LiveSession>(options, "sim", HardwareOptions{}, prepared, folder.path(),
                                         robot::Person::AtTheConsole);
    bus = std::make_unique<transport::Participant>(
        live::bus_settings(live->settings(), security::Role::Console));
    person = std::make_unique<PersonAtConsole>(*bus, *live, folder.path(),
                                               open_case(prepared.given, folder / "case"));
    std::vector<std::string> words{"--port", "0"};
    words.insert(words.end(), more.begin(), more.end());
    live->launcher().start(Process::Navigation, words);
    const std::string expected = "127.0.0.1:";
    wait(20s, [&] {
      const std::string told = read_file_if_present(folder / "navigation.txt");
      const std::size_t at = told.find(expected);
      if (at != std::string::npos && told.back() == '\n')
        port = static_cast<std::uint16_t>(std::stoi(told.substr(at + expected.size())));
      return port != 0;
    });
  }
  ~Site() { person.reset(); }
  template <class Condition>
  static bool wait(std::chrono::milliseconds patience, const Condition& holds) {
    for (auto waited = 0ms; waited < patience && !holds(); waited += 5ms) std::this_thread::sleep_for(5ms);
    return holds();
  }
  // A robot that tripped is not waited for, once it was safe.
  bool in(Mode mode, std::chrono::milliseconds patience = 20s) const {
    const auto ended = [&] {
      return person->mode == mode || (mode != Mode::Safe && person->mode == Mode::Trip);
    };
    return wait(patience, ended) && person->mode == mode;
  }
  std::string kept(const std::string& what) const {
    return fmt::format("{} but in {}; {}", what, safety::name_of(person->mode.load()),
                       robot::hazard_text(person->hazard, person->panel_unread_ms));
  }
  igtl::Transform calibration() const {
    const Plan& plan = std::get<Plan>(prepared.plan);
    return igtl::tip_at(plan.X_SR, Millimetres(0));
  }
  igtl::Transform target(double deeper_mm = 0.0) const {
    const Plan& plan = std::get<Plan>(prepared.plan);
    return igtl::tip_at(plan.X_SR, plan.target_depth + Millimetres(deeper_mm));
  }
};

struct Navigator {
  igtl::TestClient client;
  igtl::Dialect dialect;
  explicit Navigator(const Site& site, igtl::Dialect its = igtl::Dialect::Of2013)
      : client(site.port), dialect(its) {}

  // What came until `wanted` did; what did not is told at the end.
  igtl::Script until(const std::string& wanted, std::chrono::milliseconds patience = 20s) {
    igtl::Script all;
    const bool came = Site::wait(patience, [&] {
      for (std::string& one : client.came()) all.push_back(std::move(one));
      return std::ranges::find(all, wanted) != all.end();
    });
    if (!came) all.push_back(fmt::format("no {}, but {}", wanted, all.empty() ? "nothing" : all.back()));
    return all;
  }
  igtl::Script command(const std::string& text, const std::string& last) {
    client.send({"CMD_7", igtl::Text{text}});
    return until(last);
  }
  // Up to an accepted target; what came instead of an expected answer, or nothing.
  std::string target(const Site& site) {
    std::string wrong = missing(command("START_UP", "STATUS START_UP 1"));
    const bool is_2021 = dialect == igtl::Dialect::Of2021;
    command("CALIBRATION", is_2021 ? "STATUS CALIBRATION 1" : "STATUS CURRENT_STATUS 1 CALIBRATION");
    client.send({"CLB_8", site.calibration()});
    if (wrong.empty()) wrong = missing(until("STATUS CALIBRATION 1"));
    return wrong.empty() ? aim(site) : wrong;
  }
  std::string aim(const Site& site) {
    command("TARGETING", "STATUS TARGETING 1");
    client.send({"TGT_9", site.target()});
    return missing(
        until(dialect == igtl::Dialect::Of2021 ? "TRANSFORM REACHABLE_TARGET" : "TRANSFORM TARGET"));
  }
  static std::string missing(const igtl::Script& came) {
    return came.back().starts_with("no ") ? came.back() : std::string();
  }
};

}  // namespace biopsy::robot
