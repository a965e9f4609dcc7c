// OperatorSession and a navigation program: its points become a plan that a person confirms, its stop is one.
// The points are those of the built-in case "gap", put into the frame of a calibration that is made here.
#include <gtest/gtest.h>

#include "planner/plan/registration.hpp"
#include "robot/console/operator_session.hpp"
#include "robot/igtl/bus_robot.hpp"
#include "robot/procedure/procedure.hpp"
#include "safety/types/hazards.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

namespace commands = console::commands;
constexpr console::Client kPage = 1;

class OperatorNavigation : public testing::Test {
 protected:
  ScratchFolder folder_;
  std::vector<std::array<std::uint64_t, 2>> sent_;
  OperatorSession session_{
      open_case(read_case("gap"), folder_ / "case"), true, folder_.path(), 1,
      [this](const Plan&, const std::array<std::uint64_t, 2>& confirmed) { sent_.push_back(confirmed); }};
  const Target target_ = session_.prepared().target;
  igtl::Wish wish_;
  std::int64_t now_us_ = 0;

  void SetUp() override {
    session_.connect(kPage);
    wish_.X_SR = planner::needle_pose(target_.p_SE, target_.p_ST);
    wish_.p_ST = target_.p_ST;
  }
  bool page(const console::commands::Any& command) {
    const auto answer = session_.handle(kPage, command, now_us_);
    return answer && answer->done;
  }
  NavigationReply navigation() { return session_.navigate(igtl::request_of(wish_), now_us_); }
  void says(Mode mode) {
    now_us_ += 1'000;
    session_.inputs(now_us_);
    CycleSample cycle{};
    cycle.record.supervisor.permit.mode = mode;
    session_.update(cycle, now_us_);
  }
  StopCategory stop() { return session_.inputs(now_us_).stop; }
  std::string codes() {
    std::string text;
    for (const auto& alarm : session_.state(kPage, now_us_).alarms) text += alarm.code + " ";
    return text;
  }
  void confirm() {
    ASSERT_TRUE(page(commands::ConfirmPlan{1, session_.planned().seal})) << session_.planned().refusal;
    for (const console::Tick tick : {console::Tick::Patient, console::Tick::Place, console::Tick::Risks})
      ASSERT_TRUE(page(commands::SetTick{1, tick, true, session_.planned().seal}));
  }
};

TEST_F(OperatorNavigation, PlansToItsPointsWhichOnlyAPersonConfirms) {
  EXPECT_EQ(navigation().proposal, 0U);
  wish_.proposal = 1;
  NavigationReply reply = navigation();
  EXPECT_EQ(reply.proposal, 1U);
  ASSERT_TRUE(reply.planned) << reply.why;
  EXPECT_FALSE(reply.confirmed);
  EXPECT_EQ(reply.steps, std::get<Plan>(session_.prepared().plan).steps.size());
  EXPECT_NEAR(session_.planned().depth, (target_.p_ST - target_.p_SE).norm(), 1e-3);
  EXPECT_EQ(codes(), "E-125 ");
  says(Mode::Safe);
  EXPECT_TRUE(sent_.empty());
  confirm();
  says(Mode::Safe);
  EXPECT_EQ(sent_.size(), 1U);
  EXPECT_TRUE(navigation().confirmed);
  EXPECT_EQ(codes(), "");
  EXPECT_NE(navigation().why.find("Not ready yet"), std::string::npos) << navigation().why;
}

TEST_F(OperatorNavigation, ANewTargetNeedsANewConfirmation) {
  wish_.proposal = 1;
  navigation();
  confirm();
  ASSERT_TRUE(navigation().confirmed);
  wish_.proposal = 2;
  wish_.p_ST -= 0.5 * wish_.X_SR.linear().col(2);
  const NavigationReply reply = navigation();
  EXPECT_TRUE(reply.planned);
  EXPECT_FALSE(reply.confirmed);
  wish_.proposal = 0;  // taken back
  confirm();
  navigation();
  EXPECT_FALSE(session_.planned().confirmed);
}

TEST_F(OperatorNavigation, SaysWhyThereIsNoPlan) {
  wish_.proposal = 1;
  wish_.p_ST = target_.p_SE + 11.4 * wish_.X_SR.linear().col(2);
  EXPECT_NE(navigation().why.find("11.4"), std::string::npos) << navigation().why;
  EXPECT_FALSE(navigation().planned);
  wish_.proposal = 2;
  wish_.X_SR.translation() += Point(500, 0, 0);
  wish_.p_ST = wish_.X_SR * Point(0, 0, 2);
  EXPECT_NE(navigation().why.find("outside the image"), std::string::npos) << navigation().why;
  wish_.X_SR.translation() -= Point(500, 0, 0);
  wish_.p_ST = target_.p_ST;
  says(Mode::Armed);
  wish_.proposal = 3;
  EXPECT_NE(navigation().why.find("in use"), std::string::npos) << navigation().why;
  says(Mode::Safe);
  wish_.proposal = 4;
  EXPECT_TRUE(navigation().planned) << navigation().why;
}

// The case's own registration is used for the points that a person sets.
TEST_F(OperatorNavigation, APersonsPointsReplaceTheProposal) {
  wish_.X_SR.translation() += 0.3 * wish_.X_SR.linear().col(0);
  wish_.p_ST += 0.3 * wish_.X_SR.linear().col(0);
  wish_.proposal = 1;
  ASSERT_TRUE(navigation().planned) << navigation().why;
  const Volume& image = session_.prepared().image;
  for (const auto& [mark, p_S] :
       {std::pair{console::Mark::Entry, target_.p_SE}, {console::Mark::Target, target_.p_ST}}) {
    const Eigen::Vector3d voxel = image.grid.X_SI.inverse() * p_S;
    const Point ras = ras_from_lps(p_S);
    ASSERT_TRUE(page(commands::SetPoint{
        1, mark, image.identity.series_uid, {voxel.x(), voxel.y(), voxel.z()}, {ras.x(), ras.y(), ras.z()}}));
  }
  EXPECT_FALSE(session_.prepared().given.transform);
  EXPECT_NEAR(session_.planned().axis_offset, 0.0, 1e-9);
  const NavigationReply reply = navigation();
  EXPECT_FALSE(reply.planned);
  EXPECT_NE(reply.why.find("other points"), std::string::npos);
  confirm();
  EXPECT_FALSE(navigation().confirmed);
}

TEST_F(OperatorNavigation, ItsStopIsOneForAsLongAsItIsWished) {
  wish_.proposal = 1;
  navigation();
  confirm();
  for (const Mode mode : {Mode::Ready, Mode::Armed, Mode::Active}) says(mode);
  wish_.motion = true;
  navigation();
  EXPECT_EQ(codes(), "E-126 ");
  EXPECT_EQ(stop(), StopCategory::None);
  wish_.motion = false;
  wish_.stop = StopCategory::C1Ramp;
  navigation();
  EXPECT_EQ(stop(), StopCategory::C1Ramp);
  EXPECT_EQ(codes(), "E-127 ");
  for (int i = 0; i < 2'000; ++i) says(Mode::Safe);
  EXPECT_EQ(stop(), StopCategory::C1Ramp);
  wish_.stop = StopCategory::None;
  navigation();
  EXPECT_EQ(stop(), StopCategory::None);
}

TEST_F(OperatorNavigation, ItsEmergencyStandsUntilAPersonResets) {
  says(Mode::Ready);
  wish_.stop = StopCategory::C0Off;
  navigation();
  wish_.stop = StopCategory::None;
  navigation();
  for (int i = 0; i < 5'000; ++i) says(Mode::Safe);
  EXPECT_EQ(stop(), StopCategory::C0Off);
  ASSERT_TRUE(page(commands::Reset{1}));
  EXPECT_EQ(stop(), StopCategory::None);
}

TEST_F(OperatorNavigation, NobodyResetsATripWhileItsEmergencyStands) {
  for (const Mode mode : {Mode::Ready, Mode::Armed}) says(mode);
  wish_.stop = StopCategory::C0Off;
  navigation();
  says(Mode::Trip);
  EXPECT_FALSE(page(commands::Reset{1}));
  wish_.stop = StopCategory::None;
  navigation();
  EXPECT_TRUE(page(commands::Reset{1}));
}

TEST_F(OperatorNavigation, ATargetThatComesWhileTheLastRunEndsIsAnsweredWhenItHasEnded) {
  wish_.proposal = 1;
  navigation();
  confirm();
  for (const Mode mode : {Mode::Ready, Mode::Armed, Mode::Active, Mode::Trip}) says(mode);
  wish_.proposal = 2;
  EXPECT_EQ(navigation().proposal, 1U);  // not refused
  for (int i = 0; i < 1'000; ++i) says(Mode::Safe);
  EXPECT_EQ(navigation().proposal, 1U);
  for (int i = 0; i < 1'000; ++i) says(Mode::Safe);
  const NavigationReply reply = navigation();
  EXPECT_EQ(reply.proposal, 2U);
  EXPECT_TRUE(reply.planned) << reply.why;
  EXPECT_FALSE(reply.confirmed);
}

TEST_F(OperatorNavigation, WhereItGoesDuringItsMotionTheNeedleIsRetracted) {
  wish_.proposal = 1;
  navigation();
  confirm();
  for (const Mode mode : {Mode::Ready, Mode::Armed, Mode::Active}) says(mode);
  wish_.motion = true;
  navigation();
  EXPECT_EQ(session_.navigate(std::nullopt, now_us_).proposal, 0U);
  EXPECT_EQ(stop(), StopCategory::C1Ramp);
}

TEST_F(OperatorNavigation, WhereItGoesWithoutAMotionNothingHappens) {
  wish_.proposal = 1;
  navigation();
  confirm();
  for (const Mode mode : {Mode::Ready, Mode::Armed, Mode::Active}) says(mode);
  session_.navigate(std::nullopt, now_us_);
  EXPECT_EQ(stop(), StopCategory::None);
}

}  // namespace
}  // namespace biopsy::robot
