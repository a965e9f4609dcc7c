// Interlock, controller and supervisor from main() to the end: what each does in a turn besides its
// loop, what it logs, and that systemd hears of it.
#include "drivers/digital_io/interlock_relay.hpp"
#include "tests/drivers/digital_io/high_voltage.hpp"
#include "tests/robot/live/processes/process_bench.hpp"

namespace biopsy::processes_tests {
namespace {

using std::chrono::milliseconds;

struct InterlockMain : ProcessBench {
  int run_interlock() {
    std::vector<std::string> words{"biopsy-interlock", folder.path().string(), "--log-file",
                                   (folder / "run/interlock.log").string()};
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    return interlock_main(static_cast<int>(pointers.size()), pointers.data());
  }
};

TEST_F(InterlockMain, ClosesTheRelayWhileBothSidesFeedItAndOpensItAtItsEnd) {
  digital_io::StageIo stage(folder.path());
  digital_io::SupervisorIo supervisor(folder.path());
  const digital_io::IoReader reader(folder.path());
  bool closed = false;
  machine.on_tick = [&](int tick) {
    closed = reader.is_supplied(fake_bus::state().now_ns);
    if (tick == 1) {
      EXPECT_FALSE(closed);
      EXPECT_EQ(systemd.notices(), Notices{"READY=1"});
    }
    stage.pulse(), supervisor.pulse();
    stage.write(digital_io::high_voltage(1'000'000));
    if (tick == 50) stop();
  };
  EXPECT_EQ(run_interlock(), 0);
  EXPECT_TRUE(closed) << "in the last tick but one";
  EXPECT_EQ(machine.ticks, 50);
  EXPECT_EQ(machine.periods, std::vector<std::chrono::nanoseconds>{digital_io::kRelayPeriod});
  EXPECT_FALSE(reader.relay().output.closed);
  EXPECT_EQ(reader.relay().ticks, 52U) << "opens before the first tick and after the last";
  EXPECT_EQ(systemd.notices(), Notices{"STOPPING=1"});
}

TEST_F(InterlockMain, RunsAboveTheLoopsThatItGuardsWithItsMemoryLocked) {
  machine.on_tick = [](int) { stop(); };
  run_interlock();
  ASSERT_EQ(machine.asked.size(), 1U);
  EXPECT_EQ(machine.asked[0].fifo_priority, 80);
  EXPECT_TRUE(machine.asked[0].lock_memory);
  EXPECT_FALSE(machine.asked[0].threads_inherit);
  EXPECT_NE(log("interlock").find("open; as granted, 1"), std::string::npos);
}

TEST_F(InterlockMain, LogsWhatItMissedAndHowLateItWas) {
  machine.on_tick = [this](int tick) {
    machine.late_ns = tick * 3'000;
    if (tick == 4) machine.missed = 1;
    if (tick == 10) stop();
  };
  run_interlock();
  const std::string text = log("interlock");
  EXPECT_EQ(lines_with(text, " info    interlock  periods missed"), 1) << text;
  EXPECT_NE(text.find("periods missed: 1; woke 12 us late"), std::string::npos) << text;
  EXPECT_NEAR(time_us_of(text, "periods missed"), kStart_us + 2'000, kLogged_us);
  EXPECT_NE(text.find("open, ends; 10 ticks, 1 missed, late p50 15 us, p99 30 us, max 30 us"),
            std::string::npos)
      << text;
}

// 0.5 ms a tick.
TEST_F(InterlockMain, StrokesTheWatchdogTwiceInItsTime) {
  for (const auto& [watchdog_us, expected] :
       {std::pair{10'000, std::vector<int>{1, 12, 23, 34}}, {9'998, std::vector<int>{1, 11, 21, 31}}}) {
    with_watchdog(watchdog_us);
    std::vector<int> stroked;
    machine.ticks = 0;
    machine.on_tick = [&](int tick) {
      for (const std::string& notice : systemd.notices())
        if (notice == "WATCHDOG=1") stroked.push_back(tick - 1);
      if (tick == 40) stop();
    };
    run_interlock();
    EXPECT_EQ(stroked, expected) << "when more than half of it has gone by";
  }
}

TEST_F(InterlockMain, EndsWithCode2WithoutItsDigitalIo) {
  fs::remove(folder / "interlock");
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_interlock(), 2);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("to do:"), std::string::npos);
}

// Controller and supervisor wait on the bus: `turns` waits, each of a millisecond.
struct LoopMain : ProcessBench {
  void for_turns(int most, std::function<void(int)> before = {}) {
    fake_bus::state().on_wait = [this, most, before](std::chrono::nanoseconds timeout) {
      waited.push_back(timeout);
      ++turn;
      fake_bus::state().now_ns = (kStart_us + turn * 1'000) * 1'000;
      if (before) before(turn);
      if (turn >= most) stop();
    };
  }
  int turn = 0;
  std::vector<std::chrono::nanoseconds> waited;
};

using ControllerMain = LoopMain;

TEST_F(ControllerMain, AnswersMeasurementsUntilItIsStopped) {
  for_turns(5, [](int n) {
    Measurement measured;
    measured.seq = static_cast<std::uint32_t>(n);
    fake_bus::put(measured);
  });
  EXPECT_EQ(run(controller_main), 0);
  EXPECT_EQ(calls.controlled.size(), 5U);
  EXPECT_EQ(calls.controller_config, tag());
  EXPECT_EQ(fake_bus::written<DriveRequest>().size(), 5U);
  ASSERT_EQ(fake_bus::state().joined.size(), 1U);
  EXPECT_EQ(waited, std::vector<std::chrono::nanoseconds>(5, milliseconds(10)));
  EXPECT_EQ(systemd.notices(), (Notices{"READY=1", "STOPPING=1"}));
  EXPECT_NE(log("controller").find("controller started"), std::string::npos);
}

TEST_F(ControllerMain, StrokesTheWatchdogAndLogsWhatItsLoopReports) {
  with_watchdog(10'000);
  for_turns(20, [](int n) {
    for (int i = 0; i < (n == 10 ? 7 : 1); ++i) fake_bus::put(Measurement{});  // five too many at once
  });
  run(controller_main);
  EXPECT_EQ(strokes(), 4) << "at 1, 6, 11 and 16 ms";
  const std::string text = log("controller");
  EXPECT_NE(text.find("periods missed: 5, since the start 5"), std::string::npos) << text;
  EXPECT_NEAR(time_us_of(text, "periods missed"), kStart_us + 10'000, kLogged_us);
}

struct SupervisorMain : LoopMain {
  // The supervisor's decision from now on.
  void decide(Mode mode, bool pulse = false) const {
    calls.output.permit.mode = mode;
    calls.output.interlock_pulse = pulse;
  }
  std::uint32_t session_of_a_start() {
    turn = 0;
    for_turns(2);
    run(supervisor_main);
    return calls.session;
  }
};

TEST_F(SupervisorMain, DecidesUntilItIsStopped) {
  for_turns(5);
  EXPECT_EQ(run(supervisor_main), 0);
  EXPECT_FALSE(calls.supervised.empty());
  EXPECT_EQ(calls.supervisor_config, tag());
  EXPECT_EQ(calls.supervised.back().files_tag, tag()) << "as the files are now";
  EXPECT_EQ(calls.self_test, safety::SelfTest::Passed);
  EXPECT_EQ(systemd.notices(), (Notices{"READY=1", "STOPPING=1"}));
  EXPECT_NE(log("supervisor").find("supervisor started"), std::string::npos);
  machine.self_test = safety::SelfTest::Failed;
  turn = 0;
  for_turns(2);
  run(supervisor_main);
  EXPECT_EQ(calls.self_test, safety::SelfTest::Failed);
}

TEST_F(SupervisorMain, EachStartIsALaterSession) {
  const std::uint32_t first = session_of_a_start();
  EXPECT_GT(first, 0U);
  EXPECT_GT(session_of_a_start(), first);
  EXPECT_EQ(file_content(folder / "run/session"), std::to_string(calls.session) + "\n");
}

TEST_F(SupervisorMain, ReadsThePanelOfTheDigitalIo) {
  digital_io::PanelIo panel(folder.path());
  digital_io::StageIo stage(folder.path());
  panel.set({.arm_key = true, .estop_a_closed = true});
  for_turns(3, [&](int) { stage.mark_panel_read(fake_bus::state().now_ns); });
  run(supervisor_main);
  EXPECT_TRUE(calls.supervised.back().panel.read);
  EXPECT_TRUE(calls.supervised.back().panel.levels.arm_key);
}

TEST_F(SupervisorMain, PulsesItsHalfOfTheInterlockOnTheDigitalIo) {
  const digital_io::IoReader reader(folder.path());
  decide(Mode::Ready, true);
  for_turns(5);
  run(supervisor_main);
  EXPECT_EQ(reader.supervisor_pulses(), 5U);
  EXPECT_EQ(machine.board.pulses, 0);
  EXPECT_TRUE(machine.board.opened.empty()) << "a simulated stage has no board";
  EXPECT_FALSE(calls.needs_second_person) << "and its console gives both confirmations";
  turn = 0;
  decide(Mode::Trip, false);
  for_turns(5);
  run(supervisor_main);
  EXPECT_EQ(reader.supervisor_pulses(), 5U);
}

TEST_F(SupervisorMain, PulsesTheBoardsLineTooWhereThereIsOne) {
  settings.device = "nidaqmx";
  settings.device_config = folder / "board.toml";
  write_content(folder / "board.toml", "board");
  const digital_io::IoReader reader(folder.path());
  decide(Mode::Ready, true);
  for_turns(5);
  run(supervisor_main);
  EXPECT_EQ(machine.board.opened, std::vector<std::string>{"pulse nidaqmx board.toml"});
  EXPECT_EQ(machine.board.pulses, 5);
  EXPECT_TRUE(calls.needs_second_person) << "of the plan for a real stage";
  EXPECT_EQ(reader.supervisor_pulses(), 5U);
  EXPECT_EQ(log("supervisor").find("failed"), std::string::npos);
}

TEST_F(SupervisorMain, SaysOnceWhenTheBoardFailedAndKeepsShowingIt) {
  settings.device = "nidaqmx";
  settings.device_config = folder / "board.toml";
  write_content(folder / "board.toml", "board");
  const std::string failure = "the board of the supervisor's pulse failed: the interlock is open";
  for_turns(400, [this](int n) { machine.board.pulse_failed = n >= 250; });
  run(supervisor_main);
  EXPECT_EQ(lines_with(log("supervisor"), " error   supervisor " + failure), 1) << log("supervisor");
  EXPECT_EQ(lines_with(log("supervisor"), failure), 1);
  EXPECT_NEAR(time_us_of(log("supervisor"), failure), kStart_us + 250'000, kLogged_us);
  const auto told = fake_bus::written<Health>();
  ASSERT_EQ(told.size(), 4U);
  for (const std::size_t before : {0, 1, 2}) EXPECT_EQ(told[before].note, "");
  EXPECT_EQ(told.back().note, failure);
  turn = 0;
  for_turns(1);
  run(supervisor_main);
  EXPECT_EQ(lines_with(log("supervisor"), failure), 2) << "also one that failed before the first turn";
}

TEST_F(SupervisorMain, LogsEveryModeByItsNameWhenItChanges) {
  const std::vector<std::pair<Mode, std::string>> modes{
      {Mode::Safe, "safe"},     {Mode::Ready, "ready"}, {Mode::Armed, "armed"},
      {Mode::Active, "active"}, {Mode::Hold, "hold"},   {Mode::Retract, "retract"},
      {Mode::Trip, "trip"},     {Mode::Lock, "lock"},   {Mode::Boot, "boot"}};
  for_turns(3 * static_cast<int>(modes.size()),
            [&](int n) { decide(modes[static_cast<std::size_t>(n - 1) / 3].first); });
  run(supervisor_main);
  const std::string text = log("supervisor");
  EXPECT_EQ(lines_with(text, " info    supervisor mode "), 9) << text;
  EXPECT_NEAR(time_us_of(text, "mode lock"), kStart_us + 22'000, kLogged_us);
  std::size_t at = 0;
  for (const auto& [mode, name] : modes) {
    at = text.find("mode " + name, at);
    EXPECT_NE(at, std::string::npos) << name;
  }
}

TEST_F(SupervisorMain, StrokesTheWatchdog) {
  with_watchdog(10'000);
  for_turns(20);
  run(supervisor_main);
  EXPECT_EQ(strokes(), 4);
}

}  // namespace
}  // namespace biopsy::processes_tests
