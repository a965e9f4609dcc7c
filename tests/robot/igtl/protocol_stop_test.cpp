// What stops the needle: commands, a lost connection, a robot that is silent; and what it takes to go on.
#include <gtest/gtest.h>

#include <cmath>

#include "robot/igtl/bus_robot.hpp"
#include "tests/robot/igtl/scripted_robot.hpp"

namespace biopsy::igtl {
namespace {

class IgtlStop : public testing::TestWithParam<Dialect> {
 protected:
  ScriptedRobot client{GetParam()};
  StopCategory wished() const { return client.protocol.wish().stop; }
};
INSTANTIATE_TEST_SUITE_P(Dialects, IgtlStop, testing::Values(Dialect::Of2013, Dialect::Of2021),
                         [](const auto& dialect) {
                           return dialect.param == Dialect::Of2013 ? "Of2013" : "Of2021";
                         });

// By a tracker: the translation counts, the turn does not. It streams, so that it is not answered.
TEST_P(IgtlStop, APatientWhoIsMeasuredIsTold) {
  const auto tell = [this](float x, float y, float z) {
    igtl::Transform moved;
    moved.columns = {0, 1, 0, -1, 0, 0, 0, 0, 1, x, y, z};
    EXPECT_EQ(client.send({"PATIENT_MOTION", moved}), Script{});
    return request_of(client.protocol.wish()).patient_motion_um;
  };
  EXPECT_FALSE(request_of(client.protocol.wish()).measures_patient);
  EXPECT_EQ(tell(2, -3, 6), 7'000);
  EXPECT_TRUE(request_of(client.protocol.wish()).measures_patient);
  EXPECT_EQ(tell(0, 0, 0), 0);
  EXPECT_EQ(tell(1e30F, 0, 0), INT32_MAX);
  EXPECT_EQ(tell(NAN, 0, 0), INT32_MAX);
  EXPECT_EQ(tell(0, -INFINITY, 0), INT32_MAX);
}

TEST_P(IgtlStop, APatientWhoIsMeasuredNoMoreIsUnknown) {
  client.send({"PATIENT_MOTION", Transform{}});
  client.wait_ms(500);
  EXPECT_EQ(request_of(client.protocol.wish()).patient_motion_um, 0);
  client.wait_ms(2);
  EXPECT_EQ(request_of(client.protocol.wish()).patient_motion_um, INT32_MAX);
  EXPECT_TRUE(request_of(client.protocol.wish()).measures_patient);
  client.command("START_UP");
  EXPECT_TRUE(request_of(client.protocol.wish()).measures_patient) << "a new start forgets points only";
}

TEST_P(IgtlStop, IsWishedBeforeItIsAcknowledgedAndConfirmedOnceItHappened) {
  client.moving();
  EXPECT_EQ(client.command("STOP"), (Script{"STRING ACK_1 STOP", "STATUS CURRENT_STATUS 1 STOP"}));
  EXPECT_EQ(wished(), StopCategory::C1Ramp);
  EXPECT_FALSE(client.protocol.wish().motion);
  EXPECT_EQ(client.wait_ms(20), Script{});
  client.robot.mode = Mode::Retract;
  EXPECT_EQ(client.wait_ms(1), (Script{"STATUS STOP 1"}));
  EXPECT_EQ(wished(), StopCategory::C1Ramp);  // until high voltage is off
  client.robot.mode = Mode::Safe;
  client.wait_ms(300);
  EXPECT_EQ(wished(), StopCategory::None);
}

TEST_P(IgtlStop, SaysSoWhereTheRobotDoesNotConfirmIt) {
  for (const std::string phase : {"STOP", "MANUAL", "EMERGENCY"}) {
    ScriptedRobot other(GetParam());
    other.moving();
    other.command(phase);
    EXPECT_EQ(other.wait_ms(990), Script{});
    EXPECT_EQ(other.wait_ms(20), (Script{"STATUS " + phase + " 7"}));
    EXPECT_NE(other.protocol.wish().stop, StopCategory::None) << "it is still wished";
  }
}

TEST_P(IgtlStop, AfterAnEmergencyMotionIsRefusedUntilAPersonArmsAgain) {
  client.moving();
  client.command("EMERGENCY");
  EXPECT_EQ(wished(), StopCategory::C0Off);
  const auto refused = [&] {
    EXPECT_EQ(client.command("MOVE_TO_TARGET").back(), "STATUS MOVE_TO_TARGET 13");
    EXPECT_FALSE(client.protocol.wish().motion);
  };
  refused();  // the robot is still seen moving
  client.robot.mode = Mode::Armed;
  client.wait_ms(1);
  refused();  // seen armed from before
  client.robot.mode = Mode::Trip;
  EXPECT_EQ(client.wait_ms(300), Script{});
  EXPECT_EQ(wished(), StopCategory::None);
  refused();
  EXPECT_EQ(client.command("START_UP").back(), "STATUS START_UP 13");
  client.robot.mode = Mode::Safe;  // reset on the device
  client.wait_ms(300);
  refused();
  client.robot.mode = Mode::Ready;
  client.wait_ms(1);
  refused();
  client.robot.mode = Mode::Armed;
  client.wait_ms(1);
  EXPECT_EQ(client.command("MOVE_TO_TARGET").back(), "TRANSFORM CURRENT_POSITION");
  EXPECT_TRUE(client.protocol.wish().motion);
}

TEST_P(IgtlStop, ManualLocksTheVoltageOutUntilItIsLeft) {
  client.targeted();
  client.command("MANUAL");
  client.wait_ms(10'000);
  EXPECT_EQ(wished(), StopCategory::C1Ramp);
  EXPECT_EQ(client.send({"", Query::Status}), (Script{"STATUS CURRENT_STATUS 14 MANUAL"}));
  EXPECT_EQ(client.command("MOVE_TO_TARGET").back(), "STATUS MOVE_TO_TARGET 13");
  EXPECT_NE(client.reason().find("MANUAL"), std::string::npos);
  EXPECT_EQ(wished(), StopCategory::C1Ramp);
  client.command("TARGETING");
  EXPECT_EQ(wished(), StopCategory::None);
  EXPECT_EQ(client.command("MOVE_TO_TARGET").back(), "STATUS MOVE_TO_TARGET 13");
  EXPECT_NE(client.reason().find("armed on the device again"), std::string::npos);
}

TEST_P(IgtlStop, AnyOtherPhaseEndsAMotion) {
  for (const std::string phase : {"START_UP", "PLANNING", "CALIBRATION", "TARGETING"}) {
    ScriptedRobot other(GetParam());
    other.moving();
    other.command(phase);
    EXPECT_EQ(other.protocol.wish().stop, StopCategory::C1Ramp) << phase;
    EXPECT_FALSE(other.protocol.wish().motion) << phase;
  }
}

// A client that is refused does not expect a motion.
TEST_P(IgtlStop, AMoveThatIsRefusedWhileMovingEndsTheMotion) {
  client.moving();
  EXPECT_EQ(client.command("MOVE_TO_TARGET").back(), "TRANSFORM CURRENT_POSITION");  // nothing against it
  EXPECT_TRUE(client.protocol.wish().motion);
  client.robot.console = false;
  EXPECT_EQ(client.command("MOVE_TO_TARGET").back(), "STATUS MOVE_TO_TARGET 13");
  EXPECT_FALSE(client.protocol.wish().motion);
  EXPECT_EQ(wished(), StopCategory::C1Ramp);
}

TEST_P(IgtlStop, IsUnderstoodWithWhatSomeProgramsSendBehindIt) {
  for (const std::string& behind : {std::string(1, '\0'), std::string("\r\n"), std::string("  ")}) {
    ScriptedRobot other(GetParam());
    other.moving();
    EXPECT_EQ(other.command("STOP" + behind),
              (Script{"STRING ACK_1 STOP" + behind, "STATUS CURRENT_STATUS 1 STOP"}));
    EXPECT_EQ(other.protocol.wish().stop, StopCategory::C1Ramp);
  }
  EXPECT_EQ(client.command("STOP now").back(), "STATUS CURRENT_STATUS 12 STOP now");
}

TEST_P(IgtlStop, ALostConnectionIsAStop) {
  client.moving();
  client.protocol.link_lost(client.robot, client.now_us);
  EXPECT_EQ(wished(), StopCategory::C1Ramp);
  EXPECT_FALSE(client.protocol.wish().motion);
  client.robot.mode = Mode::Safe;
  EXPECT_EQ(client.wait_ms(300), Script{});
  EXPECT_EQ(wished(), StopCategory::None);
  EXPECT_EQ(client.command("TARGETING").back(), "STATUS TARGETING 1");  // it came back, without START_UP
  EXPECT_EQ(client.command("MOVE_TO_TARGET").back(), "STATUS MOVE_TO_TARGET 13");
}

TEST_P(IgtlStop, ALostConnectionIsAStopWhileTheNeedleIsHeldAtItsTarget) {
  client.moving();
  client.robot.mode = Mode::Hold;
  client.robot.step_done = true;
  client.wait_ms(1);
  ASSERT_FALSE(client.protocol.wish().motion);
  client.protocol.link_lost(client.robot, client.now_us);
  EXPECT_EQ(wished(), StopCategory::C1Ramp);
}

// A needle that a person drives without having been asked is not this client's.
TEST_P(IgtlStop, ALostConnectionThatAskedForNoMotionStopsNothing) {
  client.targeted();
  client.person_confirms_and_arms();
  client.robot.mode = Mode::Active;
  client.protocol.link_lost(client.robot, client.now_us);
  EXPECT_EQ(wished(), StopCategory::None);
}

TEST_P(IgtlStop, AMotionThatEndsEarlySaysWhy) {
  const std::tuple<Mode, std::string, std::string> kEnds[] = {
      {Mode::Trip, "needle broke through a boundary", "STATUS MOVE_TO_TARGET 3"},
      {Mode::Lock, "voltage remains", "STATUS MOVE_TO_TARGET 3"},
      {Mode::Retract, "held too long", "STATUS MOVE_TO_TARGET 13"},
      {Mode::Ready, "armed too long", "STATUS MOVE_TO_TARGET 13"}};
  for (const auto& [mode, hazard, status] : kEnds) {
    ScriptedRobot other(GetParam());
    other.moving();
    other.robot.mode = mode;
    other.robot.hazard = hazard;
    EXPECT_EQ(other.wait_ms(1), (Script{status, "TRANSFORM CURRENT_POSITION"}));
    EXPECT_NE(other.reason().find(hazard), std::string::npos);
    EXPECT_FALSE(other.protocol.wish().motion);
  }
  client.moving();
  client.robot.heard = false;
  EXPECT_EQ(client.wait_ms(1), (Script{"STATUS MOVE_TO_TARGET 18", "STATUS CURRENT_POSITION 13"}));
}

}  // namespace
}  // namespace biopsy::igtl
