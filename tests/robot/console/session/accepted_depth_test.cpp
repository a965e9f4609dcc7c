// Which depths the console accepts: of a needle that is held where its image shows it, in a patient who lies
// still.
#include <algorithm>
#include <limits>
#include <optional>

#include "safety/types/transitions.hpp"
#include "sim/scanner/dicom_series.hpp"
#include "sim/scanner/phantom.hpp"
#include "tests/robot/console/session/held_run.hpp"

namespace biopsy::robot {
namespace {

TEST(OperatorSession, AcceptsADepthWhileTheNeedleIsHeldThere) {
  HeldRun run;
  EXPECT_EQ(run.state().disabled.accept, "");
  EXPECT_TRUE(run.accept());
  EXPECT_TRUE(run.state().completed);
}

TEST(OperatorSession, DoesNotAcceptADepthThatTheNeedleHasLeft) {
  using safety::Event;
  using safety::Hazard;
  const std::tuple<std::vector<Mode>, Hazard, Event> kWays[] = {
      {{Mode::Retract}, Hazard::None, Event::HoldTooLong},
      {{Mode::Retract, Mode::Safe, Mode::Ready}, Hazard::OffsetOrScale, Event::Ramp},
      {{Mode::Trip}, Hazard::Arc, Event::Fault},
      {{Mode::Trip, Mode::Hold}, Hazard::Arc, Event::Fault}};  // no robot does that
  for (const auto& [modes, reason, event] : kWays) {
    HeldRun run;
    for (const Mode mode : modes) run.says(mode, reason, event);
    for (int i = 0; i < 100; ++i) run.says(modes.back(), reason);
    EXPECT_NE(run.state().disabled.accept, "");
    EXPECT_FALSE(run.accept());
    EXPECT_FALSE(run.state().completed);
    EXPECT_EQ(run.state().disabled.judge, "");  // it can still be rejected
    EXPECT_TRUE(run.reject());
  }
}

// In the very tick, and any time since the needle arrived: the image shows where the patient was.
TEST(OperatorSession, DoesNotAcceptADepthOfAPatientWhoMoved) {
  using safety::Hazard;
  HeldRun moves;
  moves.says(Mode::Hold);
  EXPECT_EQ(moves.state().disabled.accept, "");
  moves.worst = Hazard::PatientMotion;
  moves.says(Mode::Hold);
  EXPECT_FALSE(moves.accept());
  const events::State moving = moves.state();
  EXPECT_NE(moving.disabled.accept.find("more than 2 mm"), std::string::npos) << moving.disabled.accept;
  ASSERT_EQ(moving.alarms.size(), 1u) << "shown while it lasts, though it did not end the motion";
  EXPECT_NE(moving.alarms[0].what.find("moved"), std::string::npos) << moving.alarms[0].what;
  moves.worst = Hazard::None;
  for (int i = 0; i < 5'000; ++i) moves.says(Mode::Hold);
  EXPECT_FALSE(moves.accept()) << "it was there at this step";
  EXPECT_TRUE(moves.state().alarms.empty());
  EXPECT_FALSE(moves.state().completed);
  EXPECT_TRUE(moves.reject());

  ArrivedRun moved;  // while the image was taken
  moved.worst = Hazard::PatientMotion;
  moved.takes_image();
  moved.worst = Hazard::None;
  moved.says(Mode::Hold);
  EXPECT_FALSE(moved.accept());

  HeldRun held;  // the hold itself came of it
  held.says(Mode::Hold, Hazard::PatientMotion);
  EXPECT_FALSE(held.accept());
}

TEST(OperatorSession, DoesNotAcceptADepthWhoseImageWasDisturbed) {
  ArrivedRun run;
  run.says(Mode::Hold);
  run.disturbed = true;  // one change of sign
  run.says(Mode::Hold);
  run.disturbed = false;
  run.takes_image();
  EXPECT_NE(run.state().disabled.accept.find("The drive switched"), std::string::npos)
      << run.state().disabled.accept;
  EXPECT_FALSE(run.accept());
  EXPECT_FALSE(run.state().completed);
  EXPECT_TRUE(run.reject());

  HeldRun after;
  after.disturbed = true;  // what switches once the image is there does not matter to it
  for (int i = 0; i < 100; ++i) after.says(Mode::Hold);
  EXPECT_TRUE(after.accept());
}

// A scanner that needs a minute: until its image is there the robot knows that one is being taken.
struct ScannedRun {
  ScratchFolder incoming;
  std::optional<ArrivedRun> run;

  explicit ScannedRun(std::chrono::milliseconds patience) {
    Case given = read_case("gap");
    given.images = {incoming.path(), std::chrono::milliseconds(20), patience, ""};
    run.emplace(given);
    run->says(Mode::Hold);
  }
  bool acquires() { return run->console.session.inputs(run->console.now_us).acquiring; }
};

TEST(OperatorSession, AScannersImageIsBeingTakenUntilItIsThereOrThePersonStops) {
  for (const Mode leaves : {Mode::Retract, Mode::Trip}) {
    ScannedRun scanned(std::chrono::minutes(10));
    for (int tick = 0; tick < 60'000; ++tick) {
      scanned.run->says(Mode::Hold);
      ASSERT_TRUE(scanned.acquires()) << tick << " ms";
    }
    EXPECT_EQ(scanned.run->state().scanner, console::Scanner::Acquiring);
    EXPECT_EQ(scanned.run->state().disabled.judge,
              "Wait for the scanner's image, 600 s at most, or Retract.");
    scanned.run->says(leaves);
    EXPECT_FALSE(scanned.acquires());
  }
}

TEST(OperatorSession, AScannersImageThatDoesNotComeLeavesTheDepthUnsureOnceItsTimeIsOver) {
  ScannedRun scanned(std::chrono::milliseconds(100));
  EXPECT_TRUE(scanned.acquires());
  scanned.run->console.session.wait_for_results();
  scanned.run->says(Mode::Hold);
  EXPECT_FALSE(scanned.acquires());
  ASSERT_EQ(scanned.run->console.session.checked().size(), 1U);
  EXPECT_EQ(scanned.run->console.session.checked()[0].verdict, "unsure");
  EXPECT_NE(scanned.run->console.session.checked()[0].reason.find("within 0 s"), std::string::npos);
  EXPECT_FALSE(scanned.run->accept());
}

// Beside a worse hazard the supervisor names that one alone.
TEST(OperatorSession, DoesNotAcceptADepthWhileTheSensorShowsThatThePatientMoved) {
  for (const std::int32_t motion_um : {2'001, 40'000, -1, std::numeric_limits<std::int32_t>::max()}) {
    HeldRun run;
    NavigationRequest request;
    request.stop = StopCategory::None;
    request.measures_patient = true;
    request.patient_motion_um = 2'000;
    run.console.session.navigate(request, run.console.now_us);
    run.worst = safety::Hazard::StepDepth;
    run.says(Mode::Hold);
    EXPECT_EQ(run.state().disabled.accept, "") << "2 mm are allowed";
    request.patient_motion_um = motion_um;
    run.console.session.navigate(request, run.console.now_us);
    run.says(Mode::Hold);
    EXPECT_FALSE(run.accept()) << motion_um;
  }
}

TEST(OperatorSession, ATripUndoesAnAcceptedDepth) {
  HeldRun run;
  ASSERT_TRUE(run.accept());
  run.says(Mode::Trip, safety::Hazard::FastDrop, safety::Event::Fault);
  EXPECT_FALSE(run.state().completed);
  EXPECT_FALSE(run.accept());
}

// A new plan on the old image aims at where the patient was.
TEST(OperatorSession, AMeasuredMotionStaysUntilAnotherSeriesIsOpened) {
  const ScratchFolder folder;
  sim::Phantom phantom = sim::paper_phantom();
  for (const char* series : {"1.2.3.1", "1.2.3.2"}) {
    phantom.image.identity.series_uid = series;
    sim::write_dicom_series(phantom.image, folder / series);
  }
  ProcedureOptions options;
  options.image = folder.path();
  Case given = case_of(options, Points::PickedLater);
  given.rehearsal.motion_mm = 8.0;
  given.rehearsal.motion_deg = 0.0;
  const Point p_SE = phantom.p_SE, p_ST = phantom.p_SE + 2.0 * phantom.axis_S;
  ArrivedRun run(given, p_SE, p_ST);
  const std::string first = run.console.session.prepared().image.identity.series_uid;
  run.takes_image();
  const auto told_um = [&] { return run.console.session.inputs(run.console.now_us).patient_motion_um; };
  const std::int32_t measured_um = told_um();
  ASSERT_GT(measured_um, 2'000);
  ASSERT_TRUE(run.reject());
  for (int i = 0; i < 130'000 && run.state().report.empty(); ++i) run.says(Mode::Safe);
  while (run.state().report.empty()) std::this_thread::yield();
  ASSERT_TRUE(run.console.send(commands::ConfirmPlan{1, run.console.session.planned().seal}));
  EXPECT_EQ(told_um(), measured_um) << "the same plan";
  run.console.plan(p_SE, phantom.p_SE + 1.5 * phantom.axis_S);
  EXPECT_EQ(told_um(), measured_um) << "another plan on the same image";
  ASSERT_TRUE(run.console.open(first));
  EXPECT_EQ(told_um(), measured_um) << "the same series";
  ASSERT_TRUE(run.console.open(first == "1.2.3.1" ? "1.2.3.2" : "1.2.3.1"));
  EXPECT_EQ(told_um(), 0) << "a new image of where the patient is now";
}

}  // namespace
}  // namespace biopsy::robot
