// The operator at the console, without a page: what is asked, what the robot is told.
#include "robot/console/operator_session.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "planner/plan/seal.hpp"
#include "robot/common/config_error.hpp"
#include "robot/procedure/procedure.hpp"
#include "sim/scanner/dicom_series.hpp"
#include "sim/scanner/phantom.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

namespace commands = console::commands;
namespace events = console::events;
using console::Mark;

constexpr console::Client kPage = 1;
constexpr std::int64_t kReads_us = 1000;

struct Desk {
  ScratchFolder folder;
  OperatorSession session;
  std::vector<std::array<std::uint64_t, 2>> sent;  // the confirmations of each plan that was sent
  std::int64_t now_us = 0;

  explicit Desk(const Case& given)
      : session(open_case(given, folder / "case"), true, folder.path(), 1,
                [this](const Plan&, const std::array<std::uint64_t, 2>& confirmed) {
                  sent.push_back(confirmed);
                }) {
    session.came(kPage);
  }

  bool asks(const console::commands::Any& asked) {
    const auto answer = session.ask(kPage, asked, now_us);
    return answer && answer->done;
  }
  void robot_is(Mode mode, safety::Hazard worst) {
    now_us += kReads_us;
    session.inputs(now_us);
    CycleSample cycle{};
    cycle.record.supervisor.permit.mode = mode;
    cycle.record.supervisor.worst = worst;
    session.see(cycle, now_us);
  }
  bool opens(const std::string& series_uid) {
    if (!asks(commands::OpenSeries{1, series_uid})) return false;
    while (!session.state(kPage, now_us).reading.empty()) {
      std::this_thread::yield();
      robot_is(Mode::Safe, safety::Hazard::PlanUnconfirmed);
    }
    return session.prepared().image.identity.series_uid == series_uid;
  }
  bool sets(Mark mark, const Point& there) {
    const Volume& image = session.prepared().image;
    const Eigen::Vector3d voxel = image.grid.X_SI.inverse() * there;
    const Point ras = ras_from_lps(there);
    return asks(commands::SetPoint{
        1, mark, image.identity.series_uid, {voxel.x(), voxel.y(), voxel.z()}, {ras.x(), ras.y(), ras.z()}});
  }
  void plans(const Point& p_SE, const Point& p_ST) {
    ASSERT_TRUE(sets(Mark::Entry, p_SE));
    ASSERT_TRUE(sets(Mark::Target, p_ST));
    ASSERT_TRUE(asks(commands::ConfirmPlan{1, session.planned().seal})) << session.planned().refusal;
  }
  void ticks(bool on) {
    for (const console::Tick tick : {console::Tick::Patient, console::Tick::Place, console::Tick::Risks})
      ASSERT_TRUE(asks(commands::SetTick{1, tick, on, session.planned().seal}));
  }
};

TEST(AClinician, WhoseRobotTrippedBeforeThePlanIsConfirmedConfirmsItThenResets) {
  Desk desk(read_case("gap"));
  const Target target = desk.session.prepared().target;
  ASSERT_TRUE(desk.opens(desk.session.prepared().image.identity.series_uid));
  desk.robot_is(Mode::Trip, safety::Hazard::PlanUnconfirmed);
  EXPECT_NE(desk.session.state(kPage, desk.now_us).disabled.reset.find("Confirm the plan"),
            std::string::npos);
  desk.plans(target.p_SE, target.p_ST);
  desk.robot_is(Mode::Trip, safety::Hazard::PlanUnconfirmed);
  EXPECT_TRUE(desk.sent.empty());  // half a confirmation would only undo a whole one
  desk.ticks(true);
  desk.robot_is(Mode::Trip, safety::Hazard::PlanUnconfirmed);
  ASSERT_EQ(desk.sent.size(), 1u);
  EXPECT_NE(desk.sent[0][0], 0u);
  EXPECT_EQ(desk.sent[0][0], desk.sent[0][1]);
  desk.robot_is(Mode::Trip, safety::Hazard::None);
  EXPECT_EQ(desk.session.state(kPage, desk.now_us).disabled.reset, "");
  desk.ticks(false);
  desk.robot_is(Mode::Trip, safety::Hazard::None);
  EXPECT_EQ(desk.sent.size(), 1u);  // what is withdrawn in Trip would take the reset with it
  desk.robot_is(Mode::Safe, safety::Hazard::None);
  ASSERT_EQ(desk.sent.size(), 2u);
  EXPECT_EQ(desk.sent[1][1], 0u);
}

// Two patients in one folder, and nobody said which, or where to.
class AFolderOfImages : public ::testing::Test {
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

TEST_F(AFolderOfImages, IsOpenedByChoosingAndPlannedByClicking) {
  EXPECT_THROW(case_of(options_), ConfigError);
  Desk desk(case_of(options_, Points::PickedLater));
  ASSERT_EQ(desk.session.series().all().size(), 3u);
  for (const char* patient : {"A", "B", "A"}) {
    ASSERT_TRUE(desk.opens(std::string("1.2.3.") + (*patient == 'A' ? "1" : "2"))) << patient;
    EXPECT_TRUE(desk.session.opened()->proposal.empty());
    desk.plans(p_SE_, p_ST_);
    EXPECT_EQ(desk.session.prepared().target.patient_id, patient);
    EXPECT_NEAR(desk.session.planned().depth, 2.0, 1e-9);
  }
  EXPECT_FALSE(desk.opens("lost.nii"));
}

TEST_F(AFolderOfImages, OfACaseWithPointsIsOfOnePatient) {
  options_.entry = "0,0,0";
  EXPECT_THROW(case_of(options_, Points::PickedLater), ConfigError);  // one point is none
  options_.target = "0,0,-5";
  options_.series = "1.2.3.1";
  Desk desk(case_of(options_, Points::PickedLater));
  EXPECT_FALSE(desk.opens("1.2.3.2"));
  EXPECT_EQ(desk.session.opened().has_value(), false);
}

}  // namespace
}  // namespace biopsy::robot
