// A navigation program over TCP at one end, a person at the console's session at the other.
#include <random>

#include "tests/robot/igtl/live_site.hpp"
#include "tests/robot/live/log_mentions.hpp"
#include "tests/robot/live/steady_host.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::robot {
namespace {

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
  if (site.person->mode == Mode::Trip) return site.kept("it did not stay armed");
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

// In the dialect of 2021, where the status comes when the motion is begun.
std::string arm_again_after_an_emergency() {
  constexpr auto kDialect = igtl::Dialect::Of2021;
  Site site(kDomain + 6, read_case("gap"), {"--dialect", "2021"});
  if (site.port == 0)
    return "biopsy-igtl does not listen: " + read_file_if_present(site.folder / "navigation.txt");
  if (!site.in(Mode::Safe)) return site.kept("it was not safe");
  Navigator navigator(site, kDialect);
  EXPECT_EQ(Navigator::missing(navigator.command("PLANNING", "STATUS PLANNING 1")), "");
  if (const std::string wrong = navigator.target(site); !wrong.empty()) return site.kept(wrong);
  if (!site.in(Mode::Armed, 60s)) return site.kept("it was not armed");
  EXPECT_EQ(Navigator::missing(navigator.command("MOVE_TO_TARGET", "STATUS MOVE_TO_TARGET 1")), "");
  const auto moves = [&] { return site.person->mode == Mode::Active && site.person->drive_mV != 0; };
  if (!site.wait(10s, moves)) return site.kept("it did not move");
  site.person->arms = false;
  if (const std::string wrong = Navigator::missing(navigator.command("EMERGENCY", "STATUS EMERGENCY 1"));
      !wrong.empty())
    return site.kept(wrong);
  EXPECT_EQ(site.person->mode, Mode::Trip);
  EXPECT_EQ(Navigator::missing(navigator.command("MOVE_TO_TARGET", "STATUS MOVE_TO_TARGET 13")), "");

  site.person->resets = true;  // a person looked at the needle
  if (!site.wait(20s, [&] { return site.person->mode != Mode::Trip; })) return site.kept("it stayed tripped");
  if (const std::string wrong = navigator.aim(site); !wrong.empty()) return site.kept(wrong);
  if (!site.in(Mode::Ready)) return site.kept("it was not ready again");
  EXPECT_EQ(Navigator::missing(navigator.command("MOVE_TO_TARGET", "STATUS MOVE_TO_TARGET 13")), "")
      << "nobody armed it again";
  site.person->arms = true;
  if (!site.in(Mode::Armed, 60s)) return site.kept("it was not armed again");
  EXPECT_EQ(Navigator::missing(navigator.command("MOVE_TO_TARGET", "STATUS MOVE_TO_TARGET 1")), "");
  if (!site.wait(10s, moves)) return site.kept("it did not move again");
  site.person->arms = false;
  if (!site.in(Mode::Hold, 60s)) return site.kept("it was not held");
  EXPECT_EQ(Navigator::missing(navigator.command("CURRENT_POSITION", "TRANSFORM CURRENT_POSITION")), "");
  EXPECT_EQ(Navigator::missing(navigator.command("STOP", "STATUS STOP 1")), "");
  return {};
}

// A tracker on the patient, fifty times a second: its own connection, as its program is often another.
struct Tracker {
  igtl::TestClient client;
  std::atomic<float> moved_mm{0.0F};
  std::atomic<bool> sends{true};
  std::jthread thread;
  explicit Tracker(const Site& site) : client(site.port) {
    thread = std::jthread([this](const std::stop_token& stop) {
      for (; !stop.stop_requested(); std::this_thread::sleep_for(20ms)) {
        igtl::Transform transform;
        transform.columns[10] = moved_mm;
        if (sends) client.send({std::string(igtl::kPatientMotion), transform});
      }
    });
  }
};

std::string hold_where_the_patient_moves() {
  Site site(kDomain + 7);
  if (site.port == 0)
    return "biopsy-igtl does not listen: " + read_file_if_present(site.folder / "navigation.txt");
  if (!site.in(Mode::Safe)) return site.kept("it was not safe");
  Tracker tracker(site);
  tracker.moved_mm = 1.5F;  // less than the threshold
  Navigator navigator(site);
  if (const std::string wrong = navigator.target(site); !wrong.empty()) return site.kept(wrong);
  const auto moves = [&] { return site.person->mode == Mode::Active && site.person->drive_mV != 0; };
  const auto insert = [&] {
    if (!site.in(Mode::Armed, 60s)) return false;
    navigator.command("MOVE_TO_TARGET", "TRANSFORM CURRENT_POSITION");
    return site.wait(10s, moves);
  };
  if (!insert()) return site.kept("it did not move");
  site.person->arms = false;
  tracker.moved_mm = 2.5F;
  EXPECT_TRUE(site.wait(1s, [&] { return site.person->mode != Mode::Active; }));
  if (site.person->hazard != safety::Hazard::PatientMotion) return site.kept("another hazard came first");
  EXPECT_TRUE(site.person->mode == Mode::Hold || site.person->mode == Mode::Retract);
  EXPECT_TRUE(site.wait(20s, [&] { return !safety::hv_permitted(site.person->mode); })) << "held too long";

  tracker.moved_mm = 0.0F;
  site.person->hazard = safety::Hazard::None;
  site.person->arms = true;
  if (!insert()) return site.kept("it did not move again");
  site.person->arms = false;
  tracker.sends = false;
  EXPECT_TRUE(site.wait(2s, [&] { return site.person->mode != Mode::Active; })) << "without its sensor";
  if (site.person->hazard != safety::Hazard::PatientMotion) return site.kept("another hazard came first");
  EXPECT_TRUE(site.wait(20s, [&] { return !safety::hv_permitted(site.person->mode); }));
  site.live->stop();
  EXPECT_TRUE(live_tests::tells_of(site.folder.path(), "\"patient_motion_mm\":2.5"));
  EXPECT_TRUE(
      live_tests::tells_of(site.folder.path(), std::string(safety::name_of(safety::Hazard::PatientMotion))));
  return {};
}

TEST(LiveNavigation, APatientWhoMovesOrIsMeasuredNoMoreHoldsTheNeedle) {
  verifies("R-33");
  live_tests::on_a_steady_host(hold_where_the_patient_moves);
}

TEST(LiveNavigation, ATargetIsReachedWithAPersonAtTheConsoleAndOnlySo) {
  live_tests::on_a_steady_host(reach_a_target);
}

TEST(LiveNavigation, EmergencyTakesTheVoltageOffAndALostConnectionRetracts) {
  live_tests::on_a_steady_host(lose_the_connection_then_stop);
}

TEST(LiveNavigation, AfterAnEmergencyAPersonResetsAndArmsAgainBeforeItMoves) {
  live_tests::on_a_steady_host(arm_again_after_an_emergency);
}

constexpr int kKinds = 10, kOfEach = 60;

// What a hostile client of a kind sends.
std::vector<std::uint8_t> hostile_bytes(int kind, std::mt19937& random) {
  std::vector<std::uint8_t> bytes = igtl::encode({"CMD_1", igtl::Text{"PLANNING"}}, {});
  const std::vector<std::uint8_t> good = bytes;
  switch (kind) {
    case 0:
      return {};  // silent
    case 1:
      bytes[42] = 0x7F;  // huge body
      return bytes;
    case 2:
      bytes.pop_back();  // never ends
      return bytes;
    case 3:
      return std::vector<std::uint8_t>(3'000, static_cast<std::uint8_t>(random()));  // no protocol
    case 4:
      bytes[50] ^= 1;  // wrong CRC
      return bytes;
    case 5:  // a flood; and no answer is read
      for (int i = 0; i < 300; ++i) bytes.insert(bytes.end(), good.begin(), good.end());
      return bytes;
    case 6:
      return {bytes[0]};
    case 7:
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
      return bytes;
    case 8:
      return igtl::encode({"scan", igtl::Unusable{"IMAGE", ""}}, {});
    default:
      return igtl::encode({"x", igtl::Unusable{"POLYDATA", ""}}, {});
  }
}

// Sixty clients of a kind at a time, one kind after the other. Returns how many kinds there were.
int attack(std::uint16_t port, std::chrono::milliseconds time) {
  std::mt19937 random(21);
  std::vector<std::unique_ptr<igtl::TestClient>> open;
  int kinds = 0;
  for (const auto until = std::chrono::steady_clock::now() + time; std::chrono::steady_clock::now() < until;
       ++kinds) {
    open.clear();
    for (int n = 0; n < kOfEach; ++n) {
      open.push_back(std::make_unique<igtl::TestClient>(port));
      const std::vector<std::uint8_t> bytes = hostile_bytes(kinds % kKinds, random);
      ::send(open.back()->socket_number(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    }
    std::this_thread::sleep_for(100ms);
  }
  return kinds;
}

// Ticks that the operator's side did not get, and periods that the processes missed: as many in ten seconds
// under attack as in the five before and the five after it.
std::string bear_hostile_clients() {
  Site site(kDomain + 2);
  if (site.port == 0)
    return "biopsy-igtl does not listen: " + read_file_if_present(site.folder / "navigation.txt");
  if (!site.in(Mode::Safe)) return site.kept("it was not safe");
  constexpr auto kCalm = 5s;
  const auto missed_in = [&](const auto& act) {
    const auto missed = [&] {
      std::uint64_t sum = site.person->lost();
      for (const Health& health : site.person->health()) sum += health.overruns;
      return sum;
    };
    const std::uint64_t before = missed();
    act();
    return missed() - before;
  };
  const auto rest = [&] { std::this_thread::sleep_for(kCalm); };
  int kinds = 0;
  std::uint64_t calm = missed_in(rest);
  const std::uint64_t attacked = missed_in([&] { kinds = attack(site.port, 2 * kCalm); });
  calm += missed_in(rest);
  testing::Test::RecordProperty("missed_calm", std::to_string(calm));
  testing::Test::RecordProperty("missed_attacked", std::to_string(attacked));
  fmt::print("missed in 10 s: calm {}, attacked by {} x {} clients {}\n", calm, kinds, kOfEach, attacked);
  EXPECT_GE(kinds, kKinds) << "not every kind came";
  EXPECT_FALSE(safety::hv_permitted(site.person->mode));
  if (site.person->mode == Mode::Trip) return site.kept("it tripped");
  Navigator navigator(site);
  EXPECT_EQ(Navigator::missing(navigator.command("START_UP", "STATUS START_UP 1")), "");
  if (attacked > calm)
    return fmt::format("{}: {} missed under attack, {} without", live_tests::kNotInTime, attacked, calm);
  return {};
}

TEST(LiveNavigation, HostileClientsCostTheLoopNothing) {
  live_tests::on_a_steady_host(live_tests::Asserts::Deadline, bear_hostile_clients);
}

}  // namespace
}  // namespace biopsy::robot
