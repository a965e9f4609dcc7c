// A live robot from its run folder to the last process: when all are healthy, and how it ends. On a fake bus,
// with processes that a FakeSystem counts; the keys are real ones.
#include <sys/wait.h>

#include "planner/plan/seal.hpp"
#include "robot/common/operator_name.hpp"
#include "robot/security/cyclone_xml.hpp"
#include "tests/robot/live/loops/live_robot_bench.hpp"
#include "tests/robot/live/processes/session_bench.hpp"

namespace biopsy::robot {
namespace {

// The robot's thread takes a turn each time the session sleeps.
struct Session : SessionBench {
  Session() {
    options.keys.clear();
    fake_bus::state().on_wait = [this](auto) {
      if (free) put_measurement();
      turns.arrive();
    };
    system.on_sleep = [this] {
      fake_bus::set_clock_us(loops_tests::kStart_us + slept_ms() * 1'000);
      if (before_turn) before_turn();
      if (!free) turns.one();
    };
  }
  ~Session() override { let_go(); }
  std::int64_t slept_ms() const {
    return std::chrono::duration_cast<std::chrono::milliseconds>(system.now).count();
  }
  void let_go() {
    free = true;
    turns.release();
  }
  void put_measurement() {
    Measurement measured;
    measured.seq = ++seq;
    fake_bus::put(measured);
  }
  void begin(Person person = Person::Here) {
    session.emplace(options, "sim", hardware, prepared, folder / "run", person);
    tag = live::config_tag(folder / "run", session->settings());
  }
  void put_health(Process process, std::uint64_t config, std::uint32_t number = 1) {
    Health health;
    health.process = process, health.seq = number, health.config_tag = config;
    fake_bus::put(health);
  }

  loops_tests::Turns turns;
  std::atomic<bool> free = false;
  std::uint32_t seq = 0;
  std::function<void()> before_turn;
  std::uint64_t tag = 0;
  std::optional<LiveSession> session;
};

constexpr std::array kNeeded{Process::Recorder, Process::Supervisor, Process::Stage, Process::Controller};

TEST_F(Session, StartsTheRobotInItsRunFolderAndJoinsAsThePlanner) {
  begin();
  EXPECT_EQ(system.started.size(), 5U);
  const auto& joined = fake_bus::state().joined;
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_EQ(joined.back().domain, options.domain);
  security::CycloneOptions expected;
  expected.security = security::Security{folder / "run/keys", security::Role::Planner};
  EXPECT_EQ(joined.back().configuration, security::cyclone_xml(expected));
  EXPECT_EQ(session->settings().lines, lines());
  EXPECT_EQ(session->launcher().pid_of(Process::Stage), system.started[3]);
}

TEST_F(Session, GivesTheInterlockTheDigitalIoOfItsSettings) {
  system.starts_real_processes = true;
  write_content(folder / "programs/biopsy-interlock", "#!/bin/sh\necho \"$1\"\n");
  fs::permissions(folder / "programs/biopsy-interlock", fs::perms::owner_all);
  begin();
  for (const Process process : kStartOrder) {
    siginfo_t info{};
    const pid_t pid = session->launcher().pid_of(process);
    ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOWAIT), 0);
  }
  EXPECT_EQ(file_content(folder / "run/interlock.txt"), lines().string() + "\n");
  let_go();
}

TEST_F(Session, OfAPersonAtTheConsoleHasNoSeatOnTheBus) {
  begin(Person::AtTheConsole);
  EXPECT_TRUE(fake_bus::state().joined.empty());
  EXPECT_EQ(system.started.size(), 5U);
  let_go();
  EXPECT_TRUE(session->stop().empty());
}

TEST_F(Session, IsHealthyOnceEachProcessReportsThisConfiguration) {
  begin();
  std::size_t told = 0;
  before_turn = [&] {
    if (told < kNeeded.size()) put_health(kNeeded[told], tag);
    ++told;
  };
  session->wait_until_healthy();
  EXPECT_EQ(told, kNeeded.size());
}

TEST_F(Session, SaysWhichWereNotHeardAfterFifteenSeconds) {
  begin();
  std::size_t turn = 0;
  before_turn = [&] {  // two have another configuration, the fourth never sent anything
    switch (turn++ % 4) {
      case 0:
        return put_health(Process::Recorder, tag - 1);
      case 1:
        return put_health(Process::Supervisor, tag);
      case 2:
        return put_health(Process::Stage, tag + 1);
      default:
        return put_health(Process::Controller, tag, 0);
    }
  };
  EXPECT_EQ(what([&] { session->wait_until_healthy(); }),
            "not heard on the bus: recorder stage controller | " + (folder / "run").string());
  EXPECT_GE(slept_ms(), 15'000);
  EXPECT_LE(slept_ms(), 15'040);
}

TEST_F(Session, SaysSoWhereAProcessEndsMeanwhile) {
  begin();
  before_turn = [&] {
    if (slept_ms() < 100) return;
    system.children.at(session->launcher().pid_of(Process::Supervisor)).status = fake_system::ended_with(2);
  };
  write_content(folder / "run/supervisor.txt", "error: no keys\n");
  EXPECT_EQ(what([&] { session->wait_until_healthy(); }),
            "biopsy-supervisor ended with code 2\n  error: no keys | " + (folder / "run/*.txt").string());
  EXPECT_EQ(slept_ms(), 100);
}

TEST_F(Session, ThePlanIsConfirmedTwiceAsItWasShown) {
  begin();
  Plan plan;
  plan.target_depth = Millimetres(3.0);
  planner::seal(plan);
  const std::uint64_t shown = planner::plan_tag(plan);
  before_turn = [&] {
    Health health;
    health.process = Process::Supervisor, health.seq = 1,
    health.plan_tag = slept_ms() < 300 ? shown ^ 1 : shown;
    fake_bus::put(health);
    if (slept_ms() < 300) {
      EXPECT_TRUE(fake_bus::written<PlanConfirmation>().empty());
    }
  };
  session->send_plan(plan);
  EXPECT_EQ(slept_ms(), 300) << "the supervisor has it";
  const auto sent = fake_bus::written<SealedPlan>();
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].confirmed_tag, (std::array<std::uint64_t, 2>{shown, shown}));
  EXPECT_EQ(sent[0].bytes, planner::canonical_bytes(plan));
  const auto apart = fake_bus::written<PlanConfirmation>();
  ASSERT_EQ(apart.size(), 1U);
  EXPECT_EQ(apart[0], (PlanConfirmation{1, plan.seal, operator_name()})) << "as a real stage needs it";
}

TEST_F(Session, WaitsForASupervisorThatHasNoPlanAndThenSaysWhatItHas) {
  begin();
  Plan plan;
  planner::seal(plan);
  session->send_plan(plan);
  EXPECT_EQ(slept_ms(), 15'000);
  EXPECT_EQ(fake_bus::written<PlanConfirmation>().size(), 1U);
}

// High voltage is on until the supervisor hears of the ramp; until then few ticks come, so that the
// retraction does not end by their number.
TEST_F(Session, EndsWithTheNeedleBackBeforeAnyProcessIsAskedToEnd) {
  bool ramped = false;
  const std::ptrdiff_t threads_before = threads();
  fake_bus::state().on_wait = [&](auto) {
    for (const OperatorAct& act : fake_bus::written<OperatorAct>()) {
      if (act.stop != StopCategory::C1Ramp) continue;
      EXPECT_TRUE(system.signals.empty());
      digital_io::StageIo(lines()).mark_panel_read(1);
      EXPECT_TRUE(digital_io::IoReader(lines()).panel(1).levels.estop_a_closed)
          << "the person's hand at the panel";
      fake_bus::put(Permit{.seq = 2});
      ramped = true;
    }
    if (seq < 3 || ramped) put_measurement();
    turns.arrive();
  };
  begin();
  fake_bus::put(Permit{.seq = 1, .hv_enable = true});
  let_go();
  const pid_t stage = session->launcher().pid_of(Process::Stage);
  system.children.at(stage).on_term = fake_system::ended_with(4);
  EXPECT_TRUE(fs::exists(lines()));
  EXPECT_EQ(session->stop(), std::vector<std::string>{"biopsy-stage ended with code 4"});
  EXPECT_TRUE(ramped);
  EXPECT_EQ(threads(), threads_before) << "its thread too";
  EXPECT_TRUE(system.children.empty());
  EXPECT_FALSE(fs::exists(lines())) << "the digital I/O is gone";
  EXPECT_EQ(session->stop(), std::vector<std::string>{}) << "again";
}

TEST_F(Session, EndsWithItsOwner) {
  begin();
  let_go();
  session.reset();
  EXPECT_TRUE(system.children.empty());
  EXPECT_FALSE(fs::exists(lines()));
}

}  // namespace
}  // namespace biopsy::robot
