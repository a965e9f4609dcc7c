// OperatorSession without a page: commands in, operator inputs and confirmations out.
#include "planner/plan/seal.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/console/kept_points.hpp"
#include "safety/types/transitions.hpp"
#include "sim/scanner/dicom_series.hpp"
#include "sim/scanner/phantom.hpp"
#include "tests/robot/console/session/held_run.hpp"

namespace biopsy::robot {
namespace {

TEST(OperatorSession, ResetAfterATripNeedsTheConfirmedPlan) {
  Console console_(read_case("gap"));
  const Target target = console_.session.prepared().target;
  ASSERT_TRUE(console_.open(console_.session.prepared().image.identity.series_uid));
  console_.receive(Mode::Trip, safety::Hazard::PlanUnconfirmed);
  EXPECT_NE(console_.session.state(kPage, console_.now_us).disabled.reset.find("Confirm the plan"),
            std::string::npos);
  console_.plan(target.p_SE, target.p_ST);
  console_.receive(Mode::Trip, safety::Hazard::PlanUnconfirmed);
  EXPECT_TRUE(console_.sent.empty());  // an incomplete confirmation would revoke a complete one
  console_.tick_all(true);
  console_.receive(Mode::Trip, safety::Hazard::PlanUnconfirmed);
  ASSERT_EQ(console_.sent.size(), 1u);
  EXPECT_NE(console_.sent[0][0], 0u);
  EXPECT_EQ(console_.sent[0][0], console_.sent[0][1]);
  console_.receive(Mode::Trip, safety::Hazard::None);
  EXPECT_EQ(console_.session.state(kPage, console_.now_us).disabled.reset, "");
  console_.tick_all(false);
  console_.receive(Mode::Trip, safety::Hazard::None);
  EXPECT_EQ(console_.sent.size(), 1u);  // revoking in Trip would prevent the reset
  console_.receive(Mode::Safe, safety::Hazard::None);
  ASSERT_EQ(console_.sent.size(), 2u);
  EXPECT_EQ(console_.sent[1][1], 0u);
}

TEST(OperatorSession, ARealStageAsksForASecondPersonAndShowsTheSealToCompare) {
  for (const bool simulated : {false, true}) {
    Console console_(read_case("gap"), simulated);
    const Target target = console_.session.prepared().target;
    ASSERT_TRUE(console_.open(console_.session.prepared().image.identity.series_uid));
    console_.plan(target.p_SE, target.p_ST);
    console_.tick_all(true);
    console_.receive(Mode::Safe, safety::Hazard::PlanUnconfirmed);
    const std::string why = console_.session.state(kPage, console_.now_us).disabled.arm;
    const std::string seal = console_.session.planned().seal.substr(0, 8);
    EXPECT_EQ(why.find("`biopsy confirm` and compares the seal " + seal) != std::string::npos, !simulated)
        << why;
    console_.receive(Mode::Trip, safety::Hazard::PlanUnconfirmed);
    const std::string no_reset = console_.session.state(kPage, console_.now_us).disabled.reset;
    EXPECT_EQ(no_reset.find("`biopsy confirm`") != std::string::npos, !simulated) << no_reset;
    console_.tick_all(false);
    console_.receive(Mode::Trip, safety::Hazard::PlanUnconfirmed);
    EXPECT_NE(console_.session.state(kPage, console_.now_us).disabled.reset.find("three checks"),
              std::string::npos);
    console_.tick_all(true);
    console_.receive(Mode::Safe, safety::Hazard::PanelUntested);
    EXPECT_EQ(console_.session.state(kPage, console_.now_us).disabled.arm.find("second person"),
              std::string::npos);
  }
}

TEST(OperatorSession, PointsAreKeptOverARestartAndNeverTheirConfirmation) {
  const ScratchFolder kept;
  KeptPoints points(kept / "points.jsonl");
  Console before(read_case("gap"));
  const Target target = before.session.prepared().target;
  ASSERT_TRUE(before.open(before.session.prepared().image.identity.series_uid));
  const Point p_ST = target.p_SE + 0.8 * (target.p_ST - target.p_SE);  // not what the case proposes
  before.plan(target.p_SE, p_ST);
  before.tick_all(true);
  points.update(before.session);

  Console after(read_case("gap"));
  KeptPoints(kept / "points.jsonl").restore(after.session);
  const events::Planned planned = after.session.planned();
  const events::Planned set = before.session.planned();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(planned.entry.at(0).ras[axis], set.entry.at(0).ras[axis], 1e-6);
    EXPECT_NEAR(planned.target.at(0).ras[axis], set.target.at(0).ras[axis], 1e-6);
  }
  EXPECT_NEAR(planned.depth, set.depth, 1e-6);
  EXPECT_FALSE(planned.confirmed);
  EXPECT_EQ(after.session.state(kPage, 0).step, console::Step::Plan);
  after.receive(Mode::Safe, safety::Hazard::PlanUnconfirmed);
  for (const auto& confirmed : after.sent) EXPECT_EQ(confirmed, (std::array<std::uint64_t, 2>{0, 0}));
}

TEST(OperatorSession, KeptPointsThatAreTornOrOfAnotherSeriesAreAsNone) {
  const ScratchFolder kept;
  Console before(read_case("gap"));
  const Target target = before.session.prepared().target;
  ASSERT_TRUE(before.open(before.session.prepared().image.identity.series_uid));
  before.plan(target.p_SE, target.p_ST);
  KeptPoints(kept / "points.jsonl").update(before.session);
  const std::string whole = read_file(kept / "points.jsonl");
  const std::string uid = before.session.prepared().image.identity.series_uid;
  std::string other = whole;
  for (std::size_t at = 0; (at = other.find(uid, at)) != std::string::npos; at += 2)
    other.replace(at, uid.size(), "1.2");
  for (const std::string& wrong :
       {whole.substr(0, whole.size() / 2), other, std::string("[]"), std::string("\xff")}) {
    kept.write("points.jsonl", wrong);
    Console after(read_case("gap"));
    KeptPoints(kept / "points.jsonl").restore(after.session);
    EXPECT_TRUE(after.session.planned().entry.empty()) << wrong;
    EXPECT_TRUE(after.session.planned().target.empty()) << wrong;
  }
}

TEST(OperatorSession, AStopWithoutVoltageStandsUntilItIsReset) {
  for (const Mode mode : {Mode::Safe, Mode::Ready}) {
    Console console_(read_case("gap"));
    console_.receive(mode, safety::Hazard::None);
    EXPECT_NE(console_.session.state(kPage, console_.now_us).disabled.reset, "");
    ASSERT_TRUE(console_.send(commands::Stop{1}));
    for (int i = 0; i < 5'000; ++i) console_.receive(i % 2 == 0 ? Mode::Safe : mode, safety::Hazard::None);
    EXPECT_EQ(console_.session.inputs(console_.now_us).stop, StopCategory::C0Off);
    const events::State stopped = console_.session.state(kPage, console_.now_us);
    ASSERT_FALSE(stopped.alarms.empty());
    EXPECT_EQ(stopped.alarms[0].what, "STOP was pressed.");
    EXPECT_EQ(stopped.disabled.reset, "");
    EXPECT_NE(stopped.disabled.arm, "");
    ASSERT_TRUE(console_.send(commands::Reset{1}));
    console_.receive(mode, safety::Hazard::None);
    EXPECT_EQ(console_.session.inputs(console_.now_us).stop, StopCategory::None);
    EXPECT_TRUE(console_.session.state(kPage, console_.now_us).alarms.empty());
  }
}

// A panel that could not be read for a moment latches it as well as a hand does.
TEST(OperatorSession, AnEmergencyStopThatIsLatchedAtRestIsReset) {
  for (const Mode mode : {Mode::Safe, Mode::Ready}) {
    Console console_(read_case("gap"));
    console_.receive(mode, safety::Hazard::EStop);
    ASSERT_EQ(console_.session.state(kPage, console_.now_us).disabled.reset, "");
    EXPECT_FALSE(console_.session.inputs(console_.now_us).reset);
    ASSERT_TRUE(console_.send(commands::Reset{1}));
    EXPECT_TRUE(console_.session.inputs(console_.now_us).reset);
    for (int i = 0; i < 1'000; ++i) console_.receive(mode, safety::Hazard::None);
    EXPECT_FALSE(console_.session.inputs(console_.now_us).reset);
    EXPECT_NE(console_.session.state(kPage, console_.now_us).disabled.reset, "");
  }
}

TEST(OperatorSession, AStopThatStandsIsKeptOverARestartAndItsResetAsWell) {
  const ScratchFolder kept;
  KeptPoints points(kept / "points.jsonl");
  Console before(read_case("gap"));
  before.receive(Mode::Ready, safety::Hazard::None);
  ASSERT_TRUE(before.send(commands::Stop{1}));
  points.update(before.session);

  Console after(read_case("gap"));
  KeptPoints kept_after(kept / "points.jsonl");
  kept_after.restore(after.session);
  after.receive(Mode::Ready, safety::Hazard::None);
  EXPECT_EQ(after.session.inputs(after.now_us).stop, StopCategory::C0Off);
  const events::State stopped = after.session.state(kPage, after.now_us);
  ASSERT_FALSE(stopped.alarms.empty());
  EXPECT_EQ(stopped.alarms[0].what, "STOP was pressed.");
  EXPECT_NE(stopped.disabled.arm, "");
  ASSERT_TRUE(after.send(commands::Reset{1}));
  kept_after.update(after.session);

  Console last(read_case("gap"));
  KeptPoints(kept / "points.jsonl").restore(last.session);
  last.receive(Mode::Ready, safety::Hazard::None);
  EXPECT_EQ(last.session.inputs(last.now_us).stop, StopCategory::None);
}

// The robot is still armed in the tick after, and trips in the next.
TEST(OperatorSession, AStopOfAnArmedRobotSaysThatStopWasPressed) {
  Console console_(read_case("gap"));
  console_.receive(Mode::Armed, safety::Hazard::None);
  ASSERT_TRUE(console_.send(commands::Stop{1}));
  console_.receive(Mode::Armed, safety::Hazard::None);
  console_.receive(Mode::Trip, safety::Hazard::None);
  EXPECT_EQ(console_.session.state(kPage, console_.now_us).alarms.at(0).what, "STOP was pressed.");
}

// What the supervisor refuses in Trip (docs/reference/supervisor.md) is no control that seems to do nothing.
TEST(OperatorSession, ResetAfterATripSaysWhatIsInItsWay) {
  Console console_(read_case("gap"));
  const auto why = [&](std::int32_t depth_um, safety::Hazard worst) {
    CycleSample cycle{};
    cycle.record.supervisor.permit.mode = Mode::Trip;
    cycle.record.supervisor.worst = worst;
    cycle.record.measurement.depth_um = depth_um;
    console_.session.update(cycle, console_.now_us += kTick_us);
    std::string reason = console_.session.state(kPage, console_.now_us).disabled.reset;
    EXPECT_EQ(console_.send(commands::Reset{1}), reason.empty()) << reason;
    return reason;
  };
  EXPECT_EQ(why(2'400, safety::Hazard::None), "The needle has not returned.");
  EXPECT_NE(why(300, safety::Hazard::LaserDropout).find("Still there: H-"), std::string::npos);
  EXPECT_EQ(why(300, safety::Hazard::EStop), "");  // the key itself releases it
  EXPECT_EQ(why(300, safety::Hazard::None), "");
}

TEST(OperatorSession, SaysThatTheNeedleIsLockedAsLongAsTheBrakeIsOn) {
  Console console_(read_case("gap"));
  for (const bool on : {false, true, true, false}) {
    CycleSample cycle{};
    cycle.record.measurement.brake_on = on;
    console_.session.update(cycle, console_.now_us += kTick_us);
    EXPECT_EQ(console_.session.state(kPage, console_.now_us).locked, on);
  }
}

TEST(OperatorSession, ShowsTheMeanOfTheLastTicksAsDepth) {
  Console console_(read_case("gap"));
  for (const int depth_um : {100, 300, 200}) {
    CycleSample cycle{};
    cycle.record.measurement.depth_um = depth_um;
    cycle.record.measurement.laser_valid = true;
    console_.session.update(cycle, console_.now_us += kTick_us);
  }
  EXPECT_DOUBLE_EQ(console_.session.state(kPage, console_.now_us).depth, 0.2);
}

TEST(OperatorSession, SaysThatADepthIsKnownOnlyWhereItIsMeasured) {
  Console console_(read_case("gap"));
  const auto known = [&](bool valid, std::int32_t depth_b_um) {
    for (int i = 0; i < 200; ++i) {
      CycleSample cycle{};
      cycle.record.measurement.laser_valid = valid;
      cycle.record.measurement.laser_b_valid = true;
      cycle.record.measurement.depth_b_um = depth_b_um;
      console_.session.update(cycle, console_.now_us += kTick_us);
    }
    return console_.session.state(kPage, console_.now_us).depth_known;
  };
  EXPECT_FALSE(console_.session.state(kPage, 0).depth_known);
  EXPECT_TRUE(known(true, 0));
  EXPECT_FALSE(known(false, 0));
  EXPECT_TRUE(known(true, 100));
  EXPECT_FALSE(known(true, 1'000));
  EXPECT_TRUE(known(true, 0));
}

// Beside whatever hazard is worse, or ended the motion.
TEST(OperatorSession, SaysThatTheEmergencyStopIsThereInEveryMode) {
  Console console_(read_case("gap"));
  for (int mode = 0; mode <= static_cast<int>(Mode::Lock); ++mode)
    for (const bool pressed : {true, false}) {
      CycleSample cycle{};
      cycle.record.supervisor.permit.mode = static_cast<Mode>(mode);
      cycle.record.supervisor.worst = safety::Hazard::ResidualCharge;
      cycle.record.supervisor.reason = safety::Hazard::Arc;
      cycle.record.evidence.clear = pressed ? 0 : safety::bit(safety::Hazard::EStop);
      console_.session.update(cycle, console_.now_us += kTick_us);
      EXPECT_EQ(console_.session.state(kPage, console_.now_us).estop, pressed) << mode;
    }
}

// What a person accepted stays said, though the run does not count as completed.
TEST(OperatorSession, TheReportOfATripSaysWhetherTheDepthWasAcceptedBefore) {
  for (const bool accepted : {false, true}) {
    HeldRun run;
    if (accepted) {
      ASSERT_TRUE(run.accept());
    }
    ASSERT_TRUE(run.console.send(commands::Stop{1}));
    run.says(Mode::Trip, safety::Hazard::None, safety::Event::Fault);
    for (int i = 0; i < 130'000 && run.state().report.empty(); ++i) run.says(Mode::Trip);
    while (run.state().report.empty()) std::this_thread::yield();
    const std::string report = file_content(run.console.folder / "run-1/report.json");
    EXPECT_NE(report.find("\"stopped\""), std::string::npos);
    const std::string says = accepted ? "; the depth was accepted before" : "STOP was pressed";
    EXPECT_NE(report.find(says), std::string::npos) << report.substr(0, 600);
  }
}

// Also where a person judges the image afterwards: what came first is not lost.
TEST(OperatorSession, TheReportSaysWhatEndedTheHold) {
  for (const bool rejected : {false, true}) {
    HeldRun run;
    run.says(Mode::Retract, safety::Hazard::None, safety::Event::HoldTooLong);
    if (rejected) {
      ASSERT_TRUE(run.reject());
    }
    for (int i = 0; i < 130'000 && run.state().report.empty(); ++i) run.says(Mode::Safe);
    while (run.state().report.empty()) std::this_thread::yield();
    const std::string report = file_content(run.console.folder / "run-1/report.json");
    EXPECT_NE(report.find("\"stopped\""), std::string::npos);
    EXPECT_NE(report.find(safety::name_of(safety::Event::HoldTooLong)), std::string::npos)
        << report.substr(0, 600);
    EXPECT_EQ(report.find("rejected by the operator") != std::string::npos, rejected);
  }
}

// The robot outlives its console, and with it a plan that was confirmed there, and that nobody stands for any
// more.
TEST(OperatorSession, RestoredPointsWithdrawWhatAnEarlierConsoleConfirmed) {
  Console earlier(read_case("gap"));
  const Target target = earlier.session.prepared().target;
  ASSERT_TRUE(earlier.open(earlier.session.prepared().image.identity.series_uid));
  earlier.plan(target.p_SE, target.p_ST);
  earlier.tick_all(true);
  earlier.receive(Mode::Ready, safety::Hazard::None);
  ASSERT_FALSE(earlier.sent.empty());
  ASSERT_NE(earlier.sent.back()[1], 0u);

  Console console_(read_case("gap"));
  std::vector<commands::Any> kept{*earlier.session.chosen_series()};
  for (const commands::SetPoint& point : earlier.session.chosen_points()) kept.emplace_back(point);
  console_.session.restore(kept);
  for (int i = 0; i < 3; ++i) console_.receive(Mode::Ready, safety::Hazard::None);
  ASSERT_EQ(console_.sent.size(), 1u);
  EXPECT_EQ(console_.sent.back(), (std::array<std::uint64_t, 2>{0, 0}));
}

// An event is of one tick, and the bus may bring the next one.
TEST(OperatorSession, TheReportSaysThatTheHoldWasTooLongWithoutBeingTold) {
  HeldRun run;
  run.console.now_us += 10'000'000;
  run.says(Mode::Retract);
  EXPECT_NE(run.state().disabled.accept.find(safety::name_of(safety::Event::HoldTooLong)), std::string::npos)
      << run.state().disabled.accept;
}

// Two patients in one folder; neither series nor points are given.
class OperatorSessionWithImages : public ::testing::Test {
 protected:
  void SetUp() override {
    sim::Phantom phantom = sim::paper_phantom();
    p_SE_ = phantom.p_SE;
    p_ST_ = phantom.p_SE + 2.0 * phantom.axis_S;
    for (const char* patient : {"A", "B"}) {
      phantom.image.identity.patient_id = patient;
      phantom.image.identity.series_uid = std::string("1.2.3.") + (*patient == 'A' ? "1" : "2");
      phantom.image.identity.frame_of_reference_uid = phantom.image.identity.series_uid + ".1";
      sim::write_dicom_series(phantom.image, folder_ / patient);
    }
    folder_.write("lost.nii", std::string(400, '\0'));
    options_.image = folder_.path();
  }

  ScratchFolder folder_;
  ProcedureOptions options_;
  Point p_SE_, p_ST_;
};

TEST_F(OperatorSessionWithImages, OpensAChosenSeriesAndPlansPickedPoints) {
  EXPECT_THROW(case_of(options_), ConfigError);
  Console console_(case_of(options_, Points::PickedLater));
  ASSERT_EQ(console_.session.series().all().size(), 3u);
  for (const char* patient : {"A", "B", "A"}) {
    ASSERT_TRUE(console_.open(std::string("1.2.3.") + (*patient == 'A' ? "1" : "2"))) << patient;
    EXPECT_TRUE(console_.session.opened()->proposal.empty());
    console_.plan(p_SE_, p_ST_);
    EXPECT_EQ(console_.session.prepared().target.patient_id, patient);
    EXPECT_NEAR(console_.session.planned().depth, 2.0, 1e-9);
  }
  EXPECT_FALSE(console_.open("lost.nii"));
}

TEST_F(OperatorSessionWithImages, RefusesAnotherPatientWhereTheCaseHasPoints) {
  options_.entry = "0,0,0";
  EXPECT_THROW(case_of(options_, Points::PickedLater), ConfigError);  // both points or none
  options_.target = "0,0,-5";
  options_.series = "1.2.3.1";
  Console console_(case_of(options_, Points::PickedLater));
  EXPECT_FALSE(console_.open("1.2.3.2"));
  EXPECT_EQ(console_.session.opened().has_value(), false);
}

}  // namespace
}  // namespace biopsy::robot
