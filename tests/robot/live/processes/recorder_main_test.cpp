// The recorder from main() to its end: the procedure log from its first to its last record, and what is
// logged of it where the disk fails.
#include "robot/common/ed25519.hpp"
#include "robot/recorder/verify.hpp"
#include "robot/security/make_keys.hpp"
#include "tests/robot/live/processes/process_bench.hpp"

namespace biopsy::processes_tests {
namespace {

using std::chrono::milliseconds;

// After the last tick: for the watchdog, the last turn, the last record, and to write what is left.
constexpr int kReadsOfTheEnd = 4;

struct RecorderMain : ProcessBench {
  RecorderMain() { make_key_files(folder / "signing_key.pem"); }
  std::vector<recorder::Record> records(const fs::path& log) const {
    std::vector<recorder::Record> all;
    const auto verdict = recorder::verify(log, SigningKey(folder / "signing_key.pem").public_key(),
                                          [&](const recorder::Record& record) { all.push_back(record); });
    EXPECT_TRUE(std::holds_alternative<recorder::LogHead>(verdict));
    return all;
  }
  // Something that must be on disk at once.
  static void trip(std::uint32_t number) {
    Decision decision;
    decision.seq = number, decision.session = 1, decision.epoch = number;
    decision.mode = number % 2 == 0 ? Mode::Trip : Mode::Safe;
    fake_bus::put(decision);
  }
};

TEST_F(RecorderMain, BeginsAndEndsTheLogWithItselfAndWritesWhatCameMeanwhile) {
  machine.on_tick = [](int tick) {
    if (tick == 5) trip(2);
    if (tick != 20) return;
    trip(3);
    stop();
  };
  EXPECT_EQ(run(recorder_main), 0);
  const auto all = records(folder / "run/procedure.log.sqlite");
  ASSERT_GE(all.size(), 4U);
  EXPECT_EQ(all.front().kind, "process start");
  EXPECT_EQ(all.front().mono_us / 1'000, kStart_us / 1'000);
  EXPECT_EQ(all.front().body, "{}");
  EXPECT_EQ(all.back().kind, "process stop");
  EXPECT_EQ(all.back().mono_us / 1'000, (kStart_us + 200'000) / 1'000);
  EXPECT_EQ(std::count_if(all.begin(), all.end(),
                          [](const recorder::Record& each) { return each.kind == "state change"; }),
            2);
  EXPECT_EQ(machine.periods, std::vector<std::chrono::nanoseconds>{milliseconds(10)});
  EXPECT_EQ(systemd.notices(), (Notices{"READY=1", "STOPPING=1"}));
  EXPECT_NE(log("recorder").find("recorder   started"), std::string::npos);
  EXPECT_EQ(log("recorder").find("procedure log"), std::string::npos) << "all was well";
}

// Between the last tick and the end.
TEST_F(RecorderMain, TakesWhatIsStillOnTheBusBeforeItEnds) {
  machine.on_tick = [](int tick) {
    if (tick != 3) return;
    trip(2);
    fake_bus::state().on_clock = [] {
      fake_bus::state().on_clock = nullptr;
      trip(3);
    };
    stop();
  };
  run(recorder_main);
  const auto all = records(folder / "run/procedure.log.sqlite");
  EXPECT_EQ(std::count_if(all.begin(), all.end(),
                          [](const recorder::Record& each) { return each.kind == "state change"; }),
            2);
}

// The disk takes nothing until the very last moment.
TEST_F(RecorderMain, WritesWhatIsLeftBeforeItEnds) {
  const fs::path file = folder / "run/procedure.log.sqlite";
  int reads = 0;
  machine.on_tick = [&](int tick) {
    if (tick != 3) return;
    fs::rename(file, folder / "moved");
    trip(2);
    fake_bus::state().on_clock = [&] {
      if (++reads == kReadsOfTheEnd) fs::rename(folder / "moved", file);
    };
    stop();
  };
  run(recorder_main);
  EXPECT_EQ(reads, kReadsOfTheEnd);
  EXPECT_EQ(records(file).back().kind, "process stop");
}

TEST_F(RecorderMain, WritesIntoTheFolderThatSystemdMadeForIt) {
  fs::create_directories(folder / "state");
  ::setenv("STATE_DIRECTORY", (folder / "state").c_str(), 1);
  machine.on_tick = [](int) { stop(); };
  run(recorder_main);
  ::unsetenv("STATE_DIRECTORY");
  EXPECT_FALSE(records(folder / "state/procedure.log.sqlite").empty());
}

TEST_F(RecorderMain, LooksForStrangersOnASecuredBusOnly) {
  machine.on_tick = [](int) { stop(); };
  run(recorder_main);
  EXPECT_TRUE(fake_bus::state().monitored.empty());
  settings.keys = folder / "keys";
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  security::make_keys(settings.keys, 1, now, false);
  machine.on_tick = [](int tick) {
    fake_bus::state().endpoints = 2;
    if (tick == 300) stop();
  };
  machine.ticks = 0;
  run(recorder_main);
  ASSERT_EQ(fake_bus::state().monitored.size(), 1U);
  EXPECT_EQ(fake_bus::state().monitored[0].domain, 1'007U);
  bool alarm = false;
  for (const auto& record : records(folder / "run/procedure.log.sqlite")) {
    if (record.kind != "alarm") continue;
    alarm = true;
    EXPECT_EQ(record.mono_us % 10'000, 0) << "in the tick in which it is told";
    EXPECT_LT(record.mono_us, kStart_us + 4'000'000);
  }
  EXPECT_TRUE(alarm) << "and it writes down what the monitor finds";
}

TEST_F(RecorderMain, LogsWhenTheProcedureLogCannotBeWrittenAndWhenItCanAgain) {
  const fs::path file = folder / "run/procedure.log.sqlite";
  machine.on_tick = [&](int tick) {
    if (tick == 10) fs::rename(file, folder / "moved");
    if (tick == 50) fs::rename(folder / "moved", file);
    if (tick % 5 == 0) trip(static_cast<std::uint32_t>(tick / 5));
    if (tick == 100) stop();
  };
  run(recorder_main);
  const std::string text = log("recorder");
  EXPECT_EQ(lines_with(text, "procedure log: the log's file was moved or deleted"), 1) << text;
  EXPECT_EQ(lines_with(text, "procedure log: written again"), 1) << text;
  EXPECT_EQ(lines_with(text, "procedure log: "), 2) << text;
}

TEST_F(RecorderMain, StrokesTheWatchdogAndReportsItsHealth) {
  with_watchdog(100'000);
  machine.on_tick = [](int tick) {
    fake_bus::state().unauthenticated = 3;
    if (tick == 40) stop();
  };
  run(recorder_main);
  EXPECT_EQ(strokes(), 8);
  EXPECT_NE(log("recorder").find("participants without keys: 3"), std::string::npos) << log("recorder");
}

}  // namespace
}  // namespace biopsy::processes_tests
