// The real processes, secured, with biopsy-igtl among them: a navigation program over TCP at one end, a
// person at the console's session at the other. Nothing between them is replaced.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <random>
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
#include "tests/robot/live/steady_host.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

using namespace std::chrono_literals;
namespace commands = console::commands;
constexpr std::uint32_t kDomain = 96;  // and the next: of these tests alone
constexpr console::Client kPage = 1;

std::int64_t now_in_us() {
  return realtime::monotonic_ns() / 1000;
}

// A person who confirms what is proposed, arms, holds Insert when it is asked for, and accepts good images.
class Person {
 public:
  Person(transport::Participant& bus, const LiveSession& live, const std::filesystem::path& folder,
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

  std::atomic<bool> arms = true, inserts = true;
  std::atomic<Mode> mode = Mode::Boot;
  std::atomic<std::int64_t> drive_mV = 0;
  std::atomic<safety::Hazard> hazard = safety::Hazard::None;  // of the last trip, ramp or hold for one
  std::uint64_t lost() const { return robot_.lost(); }
  std::array<Health, kCount<Process>> health() const { return robot_.health(); }

 private:
  void step() {
    const std::int64_t now_us = now_in_us();
    link_.answer(session_.navigate(link_.newest(now_us), now_us), now_us);
    const auto cycle = robot_.tick(session_.inputs(now_us));
    if (!cycle) return session_.mark_silent();
    session_.update(*cycle, now_in_us());
    mode = cycle->record.supervisor.permit.mode;
    drive_mV = cycle->record.drive_mV;
    if (const safety::Hazard reason = cycle->record.supervisor.reason; reason != safety::Hazard::None)
      hazard = reason;
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
    const bool asked = std::ranges::any_of(state.alarms, [](const auto& one) { return one.code == "E-126"; });
    if (state.disabled.arm.empty() && arms) return hold(console::Button::Arm, true, now_us);
    if (mode == Mode::Armed && held_ && state.held.empty()) held_.reset();  // of arming
    hold(console::Button::Insert, asked && inserts && state.disabled.insert.empty(), now_us);
    if (state.disabled.accept.empty()) ask(commands::Judge{1, state.stage, console::Judgement::Accept});
  }

  LiveRobot robot_;
  NavigationLink link_;
  OperatorSession session_;
  std::optional<std::uint32_t> held_;
  std::int64_t ticks_ = 0;
  std::jthread thread_;  // last
};

struct Site {
  ScratchFolder folder;
  PreparedCase prepared = prepare(read_case("gap"), folder.path());
  std::unique_ptr<LiveSession> live;
  std::unique_ptr<transport::Participant> bus;
  std::unique_ptr<Person> person;
  std::uint16_t port = 0;

  explicit Site(std::uint32_t domain) {
    LiveOptions options;
    options.domain = domain;
    live = std::make_unique<LiveSession>(options, "sim", HardwareOptions{}, prepared, folder.path(),
                                         robot::Person::AtTheConsole);
    bus = std::make_unique<transport::Participant>(
        live::bus_settings(live->settings(), security::Role::Console));
    person = std::make_unique<Person>(*bus, *live, folder.path(), open_case(prepared.given, folder / "case"));
    live->launcher().start(Process::Navigation, {"--port", "0"});
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
  bool in(Mode mode, std::chrono::milliseconds patience = 20s) const {
    return wait(patience, [&] { return person->mode == mode; });
  }
  std::string kept(const std::string& what) const {
    return fmt::format("{}; {}", what, safety::name_of(person->hazard));
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
  explicit Navigator(const Site& site) : client(site.port) {}

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
    command("CALIBRATION", "STATUS CURRENT_STATUS 1 CALIBRATION");
    client.send({"CLB_8", site.calibration()});
    if (wrong.empty()) wrong = missing(until("STATUS CALIBRATION 1"));
    command("TARGETING", "STATUS TARGETING 1");
    client.send({"TGT_9", site.target()});
    if (wrong.empty()) wrong = missing(until("TRANSFORM TARGET"));
    return wrong;
  }
  static std::string missing(const igtl::Script& came) {
    return came.back().starts_with("no ") ? came.back() : std::string();
  }
};

// Each returns what kept it from its claim: a robot that stopped because this machine stood still.

std::string reach_a_target() {
  Site site(kDomain);
  if (site.port == 0)
    return "biopsy-igtl does not listen: " + read_file_if_present(site.folder / "navigation.txt");
  if (!site.in(Mode::Safe)) return site.kept("it was not safe");
  site.person->arms = false;
  Navigator navigator(site);
  if (const std::string wrong = navigator.target(site); !wrong.empty()) return site.kept(wrong);
  if (!site.in(Mode::Ready)) return site.kept("it was not ready");  // a person confirmed the plan
  EXPECT_EQ(Navigator::missing(navigator.command("MOVE_TO_TARGET", "STATUS MOVE_TO_TARGET 13")), "");

  site.person->inserts = false;
  site.person->arms = true;
  if (!site.in(Mode::Armed)) return site.kept("it was not armed");
  navigator.command("MOVE_TO_TARGET", "TRANSFORM CURRENT_POSITION");
  EXPECT_EQ(site.person->mode, Mode::Armed);  // nobody holds the button
  site.person->arms = false;
  site.person->inserts = true;
  const igtl::Script moved = navigator.until("STATUS MOVE_TO_TARGET 1", 60s);
  if (const std::string wrong = Navigator::missing(moved); !wrong.empty()) return site.kept(wrong);
  EXPECT_GT(std::ranges::count(moved, "TRANSFORM CURRENT_POSITION"), 3);
  if (site.person->mode != Mode::Hold) return site.kept("it was not held");
  EXPECT_EQ(Navigator::missing(navigator.command("STOP", "STATUS STOP 1")), "");
  EXPECT_TRUE(site.wait(2s, [&] { return !safety::hv_permitted(site.person->mode); }));
  return {};
}

std::string lose_the_connection_then_stop() {
  Site site(kDomain + 1);
  if (site.port == 0)
    return "biopsy-igtl does not listen: " + read_file_if_present(site.folder / "navigation.txt");
  if (!site.in(Mode::Safe)) return site.kept("it was not safe");
  const auto moving = [&](Navigator& navigator) {
    if (!site.in(Mode::Armed, 60s)) return false;
    navigator.command("MOVE_TO_TARGET", "TRANSFORM CURRENT_POSITION");
    return site.wait(10s, [&] { return site.person->mode == Mode::Active && site.person->drive_mV != 0; });
  };
  {
    Navigator navigator(site);
    if (const std::string wrong = navigator.target(site); !wrong.empty()) return site.kept(wrong);
    if (!moving(navigator)) return site.kept("it did not move");
  }  // closed
  EXPECT_TRUE(site.wait(5s, [&] { return !safety::hv_permitted(site.person->mode); }));
  Navigator navigator(site);
  navigator.command("TARGETING", "STATUS TARGETING 1");  // without START_UP: it goes on
  if (!moving(navigator)) return site.kept("it did not move again");
  site.person->arms = false;
  const auto asked = std::chrono::steady_clock::now();
  navigator.client.send({"CMD_1", igtl::Text{"EMERGENCY"}});
  if (!site.wait(2s, [&] { return site.person->mode == Mode::Trip && site.person->drive_mV == 0; }))
    return site.kept("the voltage stayed");
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - asked;
  fmt::print("EMERGENCY to 0 V: {:.0f} ms\n", took.count());
  testing::Test::RecordProperty("emergency_ms", std::to_string(took.count()));
  EXPECT_EQ(Navigator::missing(navigator.until("STATUS EMERGENCY 1")), "");
  EXPECT_EQ(site.person->mode, Mode::Trip);
  EXPECT_EQ(Navigator::missing(navigator.command("MOVE_TO_TARGET", "STATUS MOVE_TO_TARGET 13")), "");
  return {};
}

TEST(LiveNavigation, ATargetIsReachedWithAPersonAtTheConsoleAndOnlySo) {
  live_tests::on_a_steady_host(reach_a_target);
}

TEST(LiveNavigation, EmergencyTakesTheVoltageOffAndALostConnectionRetracts) {
  live_tests::on_a_steady_host(lose_the_connection_then_stop);
}

// Ten kinds of hostile clients, sixty of each, while the robot ticks: ticks that the operator's side did not
// get, and periods that the processes missed, with and without them.
TEST(LiveNavigation, HostileClientsCostTheLoopNothing) {
  Site site(kDomain + 2);
  ASSERT_NE(site.port, 0) << read_file_if_present(site.folder / "navigation.txt");
  ASSERT_TRUE(site.in(Mode::Safe));
  const auto missed = [&] {
    std::uint64_t sum = site.person->lost();
    for (const Health& health : site.person->health()) sum += health.overruns;
    return sum;
  };
  const auto while_running = [&](const auto& attack) {
    const std::uint64_t before = missed();
    attack();
    return missed() - before;
  };
  constexpr auto kTime = 10s;
  const std::uint64_t calm = while_running([&] { std::this_thread::sleep_for(kTime); });
  const std::uint64_t attacked = while_running([&] {
    std::mt19937 random(21);
    std::vector<std::unique_ptr<igtl::TestClient>> open;
    const std::vector<std::uint8_t> good = igtl::encode({"CMD_1", igtl::Text{"PLANNING"}}, {});
    const auto until = std::chrono::steady_clock::now() + kTime;
    for (int kind = 0; std::chrono::steady_clock::now() < until; kind = (kind + 1) % 10) {
      open.clear();
      for (int n = 0; n < 60; ++n) {
        open.push_back(std::make_unique<igtl::TestClient>(site.port));
        std::vector<std::uint8_t> bytes = good;
        if (kind == 1) bytes[42] = 0x7F;                                          // huge body
        if (kind == 2) bytes.pop_back();                                          // never ends
        if (kind == 3) bytes.assign(3'000, static_cast<std::uint8_t>(random()));  // no protocol
        if (kind == 4) bytes[50] ^= 1;                                            // wrong CRC
        if (kind == 5)
          for (int i = 0; i < 300; ++i) bytes.insert(bytes.end(), good.begin(), good.end());  // flood
        if (kind == 6) bytes.resize(1);                                                       // one byte
        if (kind == 7)
          for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
        if (kind == 8) bytes = igtl::encode({"scan", igtl::Unusable{"IMAGE", ""}}, {});
        if (kind == 9) bytes = igtl::encode({"x", igtl::Unusable{"POLYDATA", ""}}, {});
        if (kind != 0)
          ::send(open.back()->socket_number(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      }
      std::this_thread::sleep_for(100ms);
    }
  });
  RecordProperty("missed_calm", std::to_string(calm));
  RecordProperty("missed_attacked", std::to_string(attacked));
  fmt::print("missed in {} s: calm {}, attacked {}\n", kTime.count(), calm, attacked);
  EXPECT_FALSE(safety::hv_permitted(site.person->mode));
  EXPECT_NE(site.person->mode, Mode::Trip);
  Navigator navigator(site);
  EXPECT_EQ(Navigator::missing(navigator.command("START_UP", "STATUS START_UP 1")), "");
}

}  // namespace
}  // namespace biopsy::robot
