// What every process of the live robot does at its start and its end: the settings that it joins the bus
// with, what it asks of the kernel and when, what it tells systemd and its log.
#include "robot/live/live_process.hpp"

#include <list>

#include "robot/common/config_error.hpp"
#include "robot/common/logging/log_session.hpp"
#include "robot/security/cyclone_xml.hpp"
#include "robot/security/make_keys.hpp"
#include "tests/robot/live/processes/process_bench.hpp"

namespace biopsy::processes_tests {
namespace {

using live::LiveProcess;
using security::Role;

std::string xml_without_security() {
  security::CycloneOptions options;
  options.interface = "eth7";
  return security::cyclone_xml(options);
}

Health health_of(std::uint32_t overruns, std::uint32_t refused = 0) {
  Health health;
  health.overruns = overruns, health.refused = refused;
  return health;
}

struct OfAProcess : ProcessBench {
  OfAProcess() { write_settings(); }
  void with_keys(int days_ago = 0) {
    settings.keys = folder / "keys";
    const auto made = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    security::make_keys(settings.keys, 1, made - std::chrono::days(days_ago), false);
    write_settings();
  }
  // What a process with this role logs between its start and its end.
  std::string logged(Role role, const std::function<void(LiveProcess&)>& use) {
    logging::LogSettings to;
    to.program = "test";
    to.file = folder / "test.log";
    {
      const logging::LogSession session(to);
      LiveProcess process(folder / "run", role);
      use(process);
    }
    return file_content(to.file);
  }
};

TEST_F(OfAProcess, TheBusIsThatOfTheSettings) {
  const transport::BusSettings bus_settings = live::bus_settings(settings, Role::Stage);
  EXPECT_EQ(bus_settings.domain, 7U);
  EXPECT_EQ(bus_settings.robot, 3U);
  EXPECT_EQ(bus_settings.configuration, xml_without_security());
}

TEST_F(OfAProcess, TheBusIsSecuredWithTheKeysOfItsRole) {
  with_keys();
  for (const Role role : {Role::Stage, Role::Observer}) {
    security::CycloneOptions options;
    options.interface = "eth7";
    options.security = security::Security{folder / "keys", role};
    EXPECT_EQ(live::bus_settings(settings, role).configuration, security::cyclone_xml(options));
  }
}

TEST_F(OfAProcess, KeysAreVerifiedBeforeTheyAreUsed) {
  with_keys(2);
  EXPECT_THROW(live::bus_settings(settings, Role::Stage), ConfigError) << "they were good for a day";
  fs::remove_all(folder / "keys");
  with_keys();
  EXPECT_NO_THROW(live::bus_settings(settings, Role::Stage));
  fs::remove_all(folder / "keys/stage");
  EXPECT_THROW(live::bus_settings(settings, Role::Stage), ConfigError);
  EXPECT_THROW(LiveProcess(folder / "run", Role::Stage), ConfigError);
  EXPECT_NO_THROW(live::bus_settings(settings, Role::Controller)) << "its own only";
}

TEST_F(OfAProcess, TheSameNetworkCanBeWatchedWithoutSecurityUnderAnotherDomainOfThisProcess) {
  with_keys();
  const transport::BusSettings plain = live::plain_settings(settings);
  security::CycloneOptions options;
  options.interface = "eth7";
  options.domain_on_wire = 7;
  EXPECT_EQ(plain.configuration, security::cyclone_xml(options));
  EXPECT_EQ(plain.robot, 3U);
  for (settings.domain = 0; settings.domain <= 230; ++settings.domain)
    EXPECT_GT(live::plain_settings(settings).domain, 230U) << "none that a bus can have";
  EXPECT_EQ(plain.domain, 1'007U);
}

TEST_F(OfAProcess, ReadsItsSettingsAndJoins) {
  const LiveProcess process(folder / "run", Role::Controller);
  EXPECT_EQ(process.settings().seed, 17U);
  EXPECT_EQ(process.config_tag(), tag());
  EXPECT_EQ(process.bus().robot(), 3U);
  ASSERT_EQ(fake_bus::state().joined.size(), 1U);
  EXPECT_EQ(fake_bus::state().joined[0].configuration, xml_without_security());
  EXPECT_THROW(LiveProcess(folder / "nowhere", Role::Controller), ConfigError);
}

// Threads of the bus inherit it; memory is locked once all is allocated.
TEST_F(OfAProcess, AsksForPrecedenceBeforeItJoinsAndLocksItsMemoryBeforeItTicks) {
  settings.fifo_priority = 60;
  write_settings();
  LiveProcess process(folder / "run", Role::Stage);
  ASSERT_EQ(machine.asked.size(), 1U);
  EXPECT_FALSE(machine.asked[0].lock_memory);
  EXPECT_EQ(machine.asked[0].fifo_priority, 60);
  EXPECT_TRUE(machine.asked[0].threads_inherit);
  EXPECT_FALSE(machine.asked[0].cpu);
  process.start_ticking();
  ASSERT_EQ(machine.asked.size(), 2U);
  EXPECT_TRUE(machine.asked[1].lock_memory);
  EXPECT_EQ(machine.asked[1].fifo_priority, 0) << "what it has it keeps";
}

TEST_F(OfAProcess, NeitherTheRecorderNorOneThatIsNotToldToAsksForPrecedence) {
  const LiveProcess stage(folder / "run", Role::Stage);
  EXPECT_TRUE(machine.asked.empty());
  settings.fifo_priority = 60;
  write_settings();
  const LiveProcess recorder(folder / "run", Role::Recorder);
  EXPECT_TRUE(machine.asked.empty());
}

TEST_F(OfAProcess, LogsUnderTheNameOfItsRole) {
  for (const auto& [role, name] : {std::pair{Role::Stage, "stage"},
                                   {Role::Controller, "controller"},
                                   {Role::Supervisor, "supervisor"},
                                   {Role::Recorder, "recorder"}}) {
    fs::remove(folder / "test.log");
    const std::string text = logged(role, [](LiveProcess& process) {
      process.start_ticking();
      process.after_tick(kStart_us, health_of(1));
    });
    EXPECT_EQ(lines_with(text, std::string(" info    ") + name + " "), 2) << text;
  }
}

TEST_F(OfAProcess, LogsPeriodsThatWereMissedAndMessagesThatWereRefusedWhenTheirNumberChanges) {
  const std::string text = logged(Role::Stage, [](LiveProcess& process) {
    process.after_tick(kStart_us, {});
    for (int n = 0; n < 3; ++n) process.after_tick(kStart_us, health_of(5));
    process.after_tick(kStart_us, health_of(7, 4));
    process.after_tick(kStart_us, health_of(7, 5));
  });
  EXPECT_EQ(lines_with(text, "periods missed"), 2) << text;
  EXPECT_EQ(lines_with(text, "periods missed: 5, since the start 5"), 1);
  EXPECT_EQ(lines_with(text, "periods missed: 2, since the start 7"), 1);
  EXPECT_EQ(lines_with(text, " warning stage      messages of participants"), 2) << text;
  EXPECT_EQ(lines_with(text, "participants without keys: 4, since the start 4"), 1);
  EXPECT_EQ(lines_with(text, "participants without keys: 1, since the start 5"), 1);
}

TEST_F(OfAProcess, StrokesTheWatchdogTwiceInItsTimeAndNoOftener) {
  with_watchdog(200'000);
  LiveProcess process(folder / "run", Role::Stage);
  systemd.notices();
  std::vector<std::int64_t> stroked;
  for (std::int64_t ms = 0; ms < 1'000; ++ms) {
    process.after_tick(kStart_us + ms * 1'000, {});
    for (const std::string& notice : systemd.notices()) {
      EXPECT_EQ(notice, "WATCHDOG=1");
      stroked.push_back(ms);
    }
  }
  EXPECT_EQ(stroked, (std::vector<std::int64_t>{0, 100, 200, 300, 400, 500, 600, 700, 800, 900}));
}

// As beside a systemd that has much to do.
TEST_F(OfAProcess, StrokesTheWatchdogAgainWithTheNextTickWhereThereWasNoRoom) {
  with_watchdog(200'000);
  LiveProcess process(folder / "run", Role::Stage);
  std::list<realtime::ServiceNotice> others;  // each socket may have some 200 notices on their way
  while (others.emplace_back().watchdog())
    while (others.back().watchdog()) continue;
  process.after_tick(kStart_us, {});
  systemd.notices();
  process.after_tick(kStart_us + 1'000, {});
  process.after_tick(kStart_us + 2'000, {});
  EXPECT_EQ(systemd.notices(), Notices{"WATCHDOG=1"});
}

TEST_F(OfAProcess, StopsWhenItIsAskedTo) {
  LiveProcess process(folder / "run", Role::Stage);
  EXPECT_FALSE(process.stop_asked());
  stop();
  EXPECT_TRUE(process.stop_asked());
}

fs::path given_folder;

struct MainOfAProcess : ProcessBench {
  MainOfAProcess() { given_folder.clear(); }
  static int main_of_test(int argc, char** argv) {
    return live::live_main(argc, argv, "test", [](const fs::path& run_folder) {
      given_folder = run_folder;
      logging::Logger(logging::Component::Stage).info("runs");
    });
  }
  static int failing_main(int argc, char** argv) {
    return live::live_main(argc, argv, "test",
                           [](const fs::path&) { throw ConfigError("no keys", "keys", "make them"); });
  }
};

TEST_F(MainOfAProcess, RunsInItsFolderAndLogsThereUnderItsName) {
  EXPECT_EQ(run(main_of_test), 0);
  EXPECT_EQ(given_folder, folder / "run");
  EXPECT_NE(log("test").find("runs"), std::string::npos);
}

TEST_F(MainOfAProcess, LogsWhereItIsToldTo) {
  EXPECT_EQ(run(main_of_test, {"--log-file", (folder / "elsewhere.log").string()}), 0);
  EXPECT_NE(file_content(folder / "elsewhere.log").find("runs"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "run/test.log"));
}

TEST_F(MainOfAProcess, LogsIntoTheFolderThatSystemdMadeForIt) {
  fs::create_directories(folder / "state");
  ::setenv("STATE_DIRECTORY", (folder / "state").c_str(), 1);
  EXPECT_EQ(run(main_of_test), 0);
  ::unsetenv("STATE_DIRECTORY");
  EXPECT_NE(file_content(folder / "state/test.log").find("runs"), std::string::npos);
}

TEST_F(MainOfAProcess, SaysWhatIsWrongAndEndsWithCode2) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(run(failing_main), 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "error: no keys\nwhere: keys\nto do: make them\n");
  testing::internal::CaptureStderr();
  EXPECT_EQ(run(main_of_test, {"--nonsense"}), 2);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("where: biopsy-test"), std::string::npos);
}

}  // namespace
}  // namespace biopsy::processes_tests
