// Claims about the robot as processes: real ones, over DDS, in real time. What is measured in milliseconds is
// compared with how late this machine was meanwhile.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "drivers/digital_io/io_views.hpp"
#include "planner/plan/seal.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/ed25519.hpp"
#include "robot/live/session/live_session.hpp"
#include "robot/procedure/case/case.hpp"
#include "robot/procedure/operator.hpp"
#include "robot/procedure/rehearsal.hpp"
#include "robot/recorder/verify.hpp"
#include "tests/robot/live/in_time.hpp"
#include "tests/robot/live/live_events.hpp"
#include "tests/robot/live/live_motion.hpp"
#include "tests/robot/live/log_mentions.hpp"
#include "tests/robot/live/steady_host.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::live_tests {
namespace {

constexpr std::uint32_t kDomain = 80;  // and the next: of these tests alone

const robot::PreparedCase& gap_case() {
  static const ScratchFolder folder;
  static const robot::PreparedCase prepared = robot::prepare(robot::read_case("gap"), folder.path());
  return prepared;
}

// Its one image takes seconds, not as long as a scan.
const robot::PreparedCase& short_case() {
  static const robot::PreparedCase prepared = [] {
    robot::PreparedCase changed = gap_case();
    changed.given.rehearsal.scan = robot::kFastScan;
    return changed;
  }();
  return prepared;
}

const Plan& gap_plan() {
  return std::get<Plan>(gap_case().plan);
}

robot::LiveOptions plain() {
  robot::LiveOptions options;
  options.domain = kDomain;
  options.without_security = true;
  return options;
}

struct Reached {
  bool mode = false;
  std::string hazard;  // the worst that was present last
  explicit operator bool() const { return mode; }
};

// Goes on with the same inputs until the robot is in `mode`.
Reached reaches(robot::LiveSession& session, const robot::OperatorInputs& inputs, Mode mode, int ticks) {
  Reached reached;
  for (int n = 0; n < ticks && !reached.mode; ++n) {
    const std::optional<robot::CycleSample> cycle = session.robot().tick(inputs);
    if (!cycle) continue;
    reached.mode = cycle->record.supervisor.permit.mode == mode;
    reached.hazard = robot::hazard_text(cycle->record.supervisor.worst, cycle->record.panel_unread_ms);
  }
  return reached;
}

constexpr int kReady_ticks = 5'000;

// What the stage puts out once a decision has reached it.
digital_io::ConverterOutput settled_output(robot::LiveSession& session) {
  for (int n = 0; n < 20; ++n) session.robot().tick(robot::OperatorInputs::idle());
  return digital_io::IoReader(session.settings().lines).converter();
}

TEST(LiveRobot, RehearsesAWholeProcedureAndWritesALogThatVerifies) {
  on_a_steady_host([]() -> std::string {
    // By a slowed clock a scan would take minutes.
    const robot::PreparedCase& given = is_clock_slowed() ? short_case() : gap_case();
    const ScratchFolder folder;
    robot::LiveOptions options;
    options.domain = kDomain;
    robot::LiveSession session(options, "sim", {}, given, folder.path());
    session.wait_until_healthy();
    session.send_plan(gap_plan());
    const report::RunRecord record =
        robot::rehearse_on([&](const robot::OperatorInputs& inputs) { return session.robot().tick(inputs); },
                           given, folder.path(), [](double, const std::string&) {});
    EXPECT_TRUE(session.stop().empty());
    if (record.outcome != report::Outcome::Completed) return "the procedure was stopped: " + record.refusal;
    EXPECT_NEAR(record.final_depth_mm, 2.5, 0.1);
    EXPECT_EQ(record.layer_at_tip, "gap");
    const PublicKey key = read_public_key(folder.path() / "procedure.log.sqlite.pub.pem");
    const recorder::Verdict verdict = recorder::verify(folder.path() / "procedure.log.sqlite", key);
    const auto* head = std::get_if<recorder::LogHead>(&verdict);
    if (head != nullptr)
      EXPECT_GT(head->count, 20U);
    else
      ADD_FAILURE() << std::get<recorder::Flaw>(verdict).what;
    EXPECT_FALSE(tells_of(folder.path(), "participants_not_let_in"));
    EXPECT_FALSE(tells_of(folder.path(), "endpoints_without_keys"));
    return {};
  });
}

class LiveEventTest : public ::testing::TestWithParam<std::tuple<Process, int, double>> {};

TEST_P(LiveEventTest, TakesTheHighVoltageOff) {
  verifies(std::get<0>(GetParam()) == Process::Supervisor   ? "R-44"
           : std::get<0>(GetParam()) == Process::Controller ? "R-25"
           : std::get<0>(GetParam()) == Process::Recorder   ? "R-28"
                                                            : "R-43");
  const auto [victim, signal, allowed_ms] = GetParam();
  on_a_steady_host(
      Asserts::Deadline, [&, victim = victim, signal = signal, allowed_ms = allowed_ms]() -> std::string {
        const ScratchFolder folder;
        const EventOutcome outcome = live_event({victim, signal, 700}, plain(), gap_case(), folder.path(),
                                                victim == Process::Recorder ? 2'000 : 300);
        if (!outcome.trouble.empty()) return outcome.trouble;
        EXPECT_GE(outcome.to_zero_ms, 0.0) << "high voltage stayed on";
        const std::string which = std::string(name_of(victim)) + (signal == SIGKILL ? "_killed" : "_stopped");
        RecordProperty(which + "_to_zero_ms", fmt::format("{:.2f}", outcome.to_zero_ms));
        RecordProperty(which + "_host_late_ms", fmt::format("{:.2f}", outcome.host_late_ms));
        return in_time(outcome, allowed_ms);
      });
}

INSTANTIATE_TEST_SUITE_P(EveryProcess, LiveEventTest,
                         ::testing::Values(std::tuple(Process::Supervisor, SIGKILL, 10.0),
                                           std::tuple(Process::Supervisor, SIGSTOP, 10.0),
                                           std::tuple(Process::Controller, SIGKILL, 10.0),
                                           std::tuple(Process::Controller, SIGSTOP, 10.0),
                                           std::tuple(Process::Stage, SIGKILL, 20.0),
                                           std::tuple(Process::Stage, SIGSTOP, 20.0),
                                           std::tuple(Process::Recorder, SIGKILL, 1'500.0),
                                           std::tuple(Process::Interlock, SIGKILL, 21.0)),
                         [](const auto& given) {
                           return std::string(name_of(std::get<0>(given.param))) +
                                  (std::get<1>(given.param) == SIGKILL ? "Killed" : "Stopped");
                         });

// Which one tells first is the packets' luck: or the gate itself.
class LostPacketsLiveEventTest : public ::testing::TestWithParam<std::tuple<std::uint32_t, double>> {};

TEST_P(LostPacketsLiveEventTest, TakeTheHighVoltageOff) {
  verifies("R-26", "R-44");
  const auto [per_mille, allowed_ms] = GetParam();
  on_a_steady_host(Asserts::Deadline, [&, per_mille = per_mille, allowed_ms = allowed_ms]() -> std::string {
    const ScratchFolder folder;
    const EventOutcome outcome =
        live_event({Process::Stage, 0, 700, {.lost = per_mille}}, plain(), gap_case(), folder.path(), 3'000);
    if (!outcome.trouble.empty()) return outcome.trouble;
    EXPECT_GE(outcome.to_zero_ms, 0.0) << "high voltage stayed on";
    RecordProperty(fmt::format("lost_{}_per_mille_to_zero_ms", per_mille),
                   fmt::format("{:.2f}", outcome.to_zero_ms));
    EXPECT_GT(outcome.packets.lost, 0U) << "the wire was a good one";
    return in_time(outcome, allowed_ms);
  });
}

INSTANTIATE_TEST_SUITE_P(Some, LostPacketsLiveEventTest,
                         ::testing::Values(std::tuple(1'000U, 10.0), std::tuple(100U, 2'000.0),
                                           std::tuple(50U, 2'500.0)),
                         [](const auto& given) {
                           return std::to_string(std::get<0>(given.param)) + "InAThousand";
                         });

// Repeated packets are dropped where they arrive, and change nothing. Those that come behind the next one are
// too late for it: a few are missed like lost ones, more of them stop the robot.
class TroubledPacketsLiveEventTest : public ::testing::TestWithParam<std::pair<std::string, PacketTrouble>> {
};

TEST_P(TroubledPacketsLiveEventTest, LeaveTheRobotWithinItsLimitsOrStopIt) {
  verifies("R-26", "R-44");
  on_a_steady_host([]() -> std::string {
    const PacketTrouble& trouble = GetParam().second;
    const ScratchFolder folder;
    BadWire wire(folder.path());
    robot::LiveSession session(plain(), "sim", {}, short_case(), folder.path());
    session.wait_until_healthy();
    session.send_plan(gap_plan());
    wire.set(trouble);
    const report::RunRecord record =
        robot::rehearse_on([&](const robot::OperatorInputs& inputs) { return session.robot().tick(inputs); },
                           short_case(), folder.path(), [](double, const std::string&) {});
    wire.set({});
    session.stop();
    const PacketTrouble done = wire.done();
    EXPECT_EQ(done.doubled > 0, trouble.doubled > 0);
    EXPECT_EQ(done.late > 0, trouble.late > 0);
    int tripped_ms =
        0;  // by the robot's clock, a sample each; what that takes is asserted of killed processes
    for (const report::Sample& sample : record.samples) {
      EXPECT_LE(sample.tip_mm, gap_plan().target_depth.value + 2.0);
      EXPECT_LE(std::abs(sample.drive_kV), 8.0);
      tripped_ms = sample.mode == Mode::Trip ? tripped_ms + 1 : 0;
      if (tripped_ms > 20) {
        EXPECT_EQ(sample.drive_kV, 0.0F) << sample.time_ms;
      }
      if (::testing::Test::HasFailure()) break;
    }
    const bool completed = record.outcome == report::Outcome::Completed;
    if (!completed && trouble.late == 0) return "the procedure was stopped: " + record.refusal;
    RecordProperty(GetParam().first + "_completed", completed ? 1 : 0);
    return {};
  });
}

INSTANTIATE_TEST_SUITE_P(Some, TroubledPacketsLiveEventTest,
                         ::testing::Values(std::pair("doubled_1000", PacketTrouble{.doubled = 1'000}),
                                           std::pair("late_10", PacketTrouble{.late = 10}),
                                           std::pair("late_200", PacketTrouble{.late = 200})),
                         [](const auto& given) { return given.param.first; });

// While the needle moves somebody else begins to write what one alone may write.
template <class Message>
class SecondWriter : public ::testing::Test {};
using Commands =
    ::testing::Types<Measurement, DriveRequest, OperatorAct, SealedPlan, DepthVerdictNote, LogHealth>;
TYPED_TEST_SUITE(SecondWriter, Commands);

TYPED_TEST(SecondWriter, Trips) {
  verifies("R-11");
  on_a_steady_host([]() -> std::string {
    const ScratchFolder folder;
    const MovingRobot moving = moving_robot(plain(), gap_case(), folder.path());
    if (!moving.session) return moving.prevented_by;
    robot::LiveSession& session = *moving.session;
    transport::Writer<TypeParam> rogue(session.bus());
    EXPECT_TRUE(reaches(session, robot::OperatorInputs::idle(), Mode::Trip, 2'000));
    EXPECT_EQ(settled_output(session), digital_io::ConverterOutput{});
    return {};
  });
}

TEST(LiveRobot, ASecondWriterOfPermitsTripsAndCannotCommand) {
  verifies("R-11");
  on_a_steady_host([]() -> std::string {
    const ScratchFolder folder;
    const MovingRobot moving = moving_robot(plain(), gap_case(), folder.path());
    if (!moving.session) return moving.prevented_by;
    robot::LiveSession& session = *moving.session;
    transport::Writer<Permit> rogue(session.bus());
    Permit forged;
    forged.session = 0xffff'ffff;
    forged.epoch = 9;
    forged.seq = 0xffff'0000;
    forged.ttl_us = 5'000;
    forged.mode = Mode::Active;
    forged.stop = StopCategory::None;
    forged.hv_enable = true;
    forged.v_max_mV = 8'000'000;
    forged.slew_up_mV_per_tick = 400'000;
    for (int n = 0; n < 200; ++n) {
      ++forged.seq;
      rogue.write(forged);
      session.robot().tick(robot::OperatorInputs::idle());
    }
    EXPECT_TRUE(reaches(session, robot::OperatorInputs::idle(), Mode::Trip, 2'000));
    EXPECT_EQ(settled_output(session), digital_io::ConverterOutput{});
    return {};
  });
}

TEST(LiveRobot, TheNetworkCannotArm) {
  verifies("R-39", "R-40");
  on_a_steady_host([]() -> std::string {
    const ScratchFolder folder;
    robot::LiveSession session(plain(), "sim", {}, gap_case(), folder.path());
    session.wait_until_healthy();
    session.send_plan(gap_plan());
    const Reached ready = reaches(session, robot::OperatorInputs::idle(), Mode::Ready, kReady_ticks);
    if (!ready) return "the robot never got ready: " + ready.hazard;
    robot::OperatorInputs asking = robot::OperatorInputs::idle();
    asking.remote_arm = true;
    asking.press = {1, true};
    EXPECT_FALSE(reaches(session, asking, Mode::Armed, 1'000));
    return {};
  });
}

TEST(LiveRobot, AnotherPlanInMotionTrips) {
  verifies("R-12");
  on_a_steady_host([]() -> std::string {
    const ScratchFolder folder;
    const MovingRobot moving = moving_robot(plain(), gap_case(), folder.path());
    if (!moving.session) return moving.prevented_by;
    robot::LiveSession& session = *moving.session;
    Plan other = gap_plan();
    other.target.patient_id = "SOMEBODY ELSE";
    planner::seal(other);
    const std::uint64_t tag = planner::plan_tag(other);
    session.robot().send_plan(other, {tag, tag});
    EXPECT_TRUE(reaches(session, robot::OperatorInputs::idle(), Mode::Trip, 2'000));
    return {};
  });
}

TEST(LiveRobot, AProgramThatStandsStillHoldsNoButton) {
  verifies("R-41");
  on_a_steady_host([]() -> std::string {
    const ScratchFolder folder;
    const MovingRobot moving = moving_robot(plain(), gap_case(), folder.path());
    if (!moving.session) return moving.prevented_by;
    robot::LiveSession& session = *moving.session;
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // while its bus goes on
    robot::OperatorInputs pressing = robot::OperatorInputs::idle();
    pressing.press = {1, true};
    for (int n = 0; n < 2'000; ++n) {
      const std::optional<robot::CycleSample> cycle = session.robot().tick(pressing);
      if (!cycle) continue;
      const safety::SupervisorOutput& decided = cycle->record.supervisor;
      if (decided.permit.mode == Mode::Hold) return {};
      if (decided.permit.mode == Mode::Retract || decided.permit.mode == Mode::Trip)
        return "the robot stopped before it could hold: " +
               robot::hazard_text(decided.worst, cycle->record.panel_unread_ms);
    }
    ADD_FAILURE() << "it went on";
    return {};
  });
}

TEST(LiveRobot, APlanOfOneConfirmationIsNotReady) {
  verifies("R-30");
  on_a_steady_host([]() -> std::string {
    const ScratchFolder folder;
    robot::LiveSession session(plain(), "sim", {}, gap_case(), folder.path());
    session.wait_until_healthy();
    session.robot().send_plan(gap_plan(), {planner::plan_tag(gap_plan()), 0});
    EXPECT_FALSE(reaches(session, robot::OperatorInputs::idle(), Mode::Ready, 1'500));
    return {};
  });
}

TEST(LiveRobot, SecuredItRefusesAPersonWhoWritesRequests) {
  verifies("R-46");
  on_a_steady_host([]() -> std::string {
    const ScratchFolder folder;
    robot::LiveOptions secured;
    secured.domain = kDomain + 1;
    robot::LiveSession session(secured, "sim", {}, gap_case(), folder.path());
    session.wait_until_healthy();
    session.send_plan(gap_plan());
    const Reached ready = reaches(session, robot::OperatorInputs::idle(), Mode::Ready, kReady_ticks);
    if (!ready) return "the robot never got ready: " + ready.hazard;
    // The planner's identity may not write requests: no writer at all, and no second one is seen.
    EXPECT_THROW(transport::Writer<DriveRequest>(session.bus()), ConfigError);
    for (int n = 0; n < 500; ++n) {
      const std::optional<robot::CycleSample> cycle = session.robot().tick(robot::OperatorInputs::idle());
      if (!cycle) continue;
      EXPECT_NE(cycle->record.supervisor.worst, safety::Hazard::SecondWriter);
      if (cycle->record.supervisor.permit.mode == Mode::Safe)
        return "the robot did not stay ready: " +
               robot::hazard_text(cycle->record.supervisor.worst, cycle->record.panel_unread_ms);
    }
    return {};
  });
}

TEST(LiveRobot, MissingKeysAreNamed) {
  const ScratchFolder folder;
  robot::LiveOptions options;
  options.domain = kDomain;
  options.keys = folder.path() / "no-keys";
  try {
    robot::LiveSession session(options, "sim", {}, gap_case(), folder.path());
    FAIL() << "started without keys";
  } catch (const ConfigError& error) {
    EXPECT_NE(error.where.find("no-keys"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace biopsy::live_tests
