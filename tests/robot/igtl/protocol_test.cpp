// Every row of the protocol's table in both dialects, and every refusal with its reason.
#include "robot/igtl/protocol.hpp"

#include <gtest/gtest.h>

#include "tests/robot/igtl/scripted_robot.hpp"

namespace biopsy::igtl {
namespace {

class IgtlProtocol : public testing::TestWithParam<Dialect> {
 protected:
  bool of_2021() const { return GetParam() == Dialect::Of2021; }
  ScriptedRobot client{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Dialects, IgtlProtocol, testing::Values(Dialect::Of2013, Dialect::Of2021),
                         [](const auto& dialect) {
                           return dialect.param == Dialect::Of2013 ? "Of2013" : "Of2021";
                         });

TEST_P(IgtlProtocol, GoesThroughAProcedureInTheOrderOfTheTable) {
  EXPECT_EQ(client.command("START_UP"),
            (Script{"STRING ACK_1 START_UP", "STATUS CURRENT_STATUS 1 START_UP", "STATUS START_UP 1"}));
  Script planning{"STRING ACK_1 PLANNING", "STATUS CURRENT_STATUS 1 PLANNING"};
  if (of_2021()) planning.emplace_back("STATUS PLANNING 1");
  EXPECT_EQ(client.command("PLANNING"), planning);
  Script calibration{"STRING ACK_1 CALIBRATION", "STATUS CURRENT_STATUS 1 CALIBRATION"};
  if (of_2021()) calibration.emplace_back("STATUS CALIBRATION 1");
  EXPECT_EQ(client.command("CALIBRATION"), calibration);
  EXPECT_EQ(client.calibrate(), (Script{"TRANSFORM ACK_1", "STATUS CALIBRATION 1"}));
  EXPECT_EQ(client.command("TARGETING"),
            (Script{"STRING ACK_1 TARGETING", "STATUS CURRENT_STATUS 1 TARGETING", "STATUS TARGETING 1"}));
  EXPECT_EQ(client.aim(3.5F), (Script{"TRANSFORM ACK_1"}));  // acknowledged at once, planned at the console
  EXPECT_EQ(client.wait_ms(50), Script{});
  client.console_plans(2);
  EXPECT_EQ(client.wait_ms(1),
            (Script{"STATUS TARGET 1", of_2021() ? "TRANSFORM REACHABLE_TARGET" : "TRANSFORM TARGET"}));
  EXPECT_FLOAT_EQ(std::get<Transform>(client.last.back().body).columns[11], 3.5F);

  client.person_confirms_and_arms();
  Script begins{"STRING ACK_1 MOVE_TO_TARGET", "STATUS CURRENT_STATUS 1 MOVE_TO_TARGET"};
  if (of_2021()) begins.emplace_back("STATUS MOVE_TO_TARGET 1");
  begins.emplace_back("TRANSFORM CURRENT_POSITION");
  EXPECT_EQ(client.command("MOVE_TO_TARGET"), begins);
  EXPECT_TRUE(client.protocol.wish().motion);
  client.robot.mode = Mode::Active;
  EXPECT_EQ(client.wait_ms(1000), Script(10, "TRANSFORM CURRENT_POSITION"));
  client.robot.mode = Mode::Hold;  // between two steps an image is confirmed
  client.robot.step_done = true;
  EXPECT_EQ(client.wait_ms(1000), Script(10, "TRANSFORM CURRENT_POSITION"));
  client.robot.step = 1;
  client.robot.depth = Millimetres(3.48);
  Script ends{"STATUS MOVE_TO_TARGET 1", "TRANSFORM CURRENT_POSITION"};
  if (of_2021()) ends.erase(ends.begin());
  EXPECT_EQ(client.wait_ms(1), ends);
  EXPECT_FLOAT_EQ(std::get<Transform>(client.last.back().body).columns[11], 3.48F);
  EXPECT_FALSE(client.protocol.wish().motion);
  EXPECT_EQ(client.wait_ms(1000), Script{});
}

TEST_P(IgtlProtocol, StopsInEveryPhaseThatAsksForIt) {
  for (const std::string phase : {"MANUAL", "STOP", "EMERGENCY"}) {
    EXPECT_EQ(client.command(phase), (Script{"STRING ACK_1 " + phase, "STATUS CURRENT_STATUS 1 " + phase,
                                             "STATUS " + phase + " 1"}));
  }
}

TEST_P(IgtlProtocol, ReadsCommandsInUtf8AndAStopInAnyEncoding) {
  EXPECT_EQ(client.send({"CMD_1", Text{"PLANNING", 106}})[0], "STRING ACK_1 PLANNING");
  EXPECT_EQ(client.send({"CMD_1", Text{"STOP", 1013}})[0], "STRING ACK_1 STOP");
  EXPECT_EQ(client.send({"CMD_1", Text{"EMERGENCY", 0}})[0], "STRING ACK_1 EMERGENCY");
}

TEST_P(IgtlProtocol, EchoesTheNumberAndTheMatrixToTheBit) {
  client.command("START_UP");
  EXPECT_EQ(client.send({"CMD_12345678901234567", Text{"PLANNING"}})[0],
            "STRING ACK_12345678901234567 PLANNING");
  Transform odd;
  odd.columns = {0.1F, 1e-38F, -0.0F, 1e30F, 2, 3, 4, 5, 6, 7, 8, 9};
  client.send({"CLB_0004", odd});
  EXPECT_EQ(client.last[0], (Message{"ACK_0004", odd}));
  client.send({"TGT_0006", odd});
  EXPECT_EQ(client.last[0], (Message{"ACK_0006", odd}));
}

TEST_P(IgtlProtocol, StartsUpOnlyARobotThatIsThereAndWell) {
  client.robot.mode = Mode::Boot;
  EXPECT_EQ(client.command("START_UP").size(), 2U);  // the self-test is still running
  EXPECT_EQ(client.wait_ms(100), Script{});
  client.robot.mode = Mode::Safe;
  EXPECT_EQ(client.wait_ms(1), (Script{"STATUS START_UP 1"}));
  const auto refused_because = [&](const std::string& why) {
    EXPECT_EQ(client.command("START_UP").back(), "STATUS START_UP 13");
    EXPECT_NE(client.reason().find(why), std::string::npos) << client.reason();
  };
  client.robot.mode = Mode::Trip;
  client.robot.hazard = "emergency stop pressed or unread";
  refused_because("trip: emergency stop pressed or unread");
  client.robot.mode = Mode::Active;
  refused_because("in use");
  const auto refused_in_time_because = [&](const std::string& why) {  // it may be coming up
    EXPECT_EQ(client.command("START_UP").size(), 2U);
    EXPECT_EQ(client.wait_ms(8'900), Script{});
    EXPECT_EQ(client.wait_ms(100), (Script{"STATUS START_UP 13"}));
    EXPECT_NE(client.reason().find(why), std::string::npos) << client.reason();
  };
  client.robot.mode = Mode::Safe;
  client.robot.console = false;
  refused_in_time_because("no console");
  client.robot.heard = false;
  refused_in_time_because("silent");
  client.robot.heard = client.robot.console = true;
  client.robot.mode = Mode::Boot;
  refused_in_time_because("boot");
}

TEST_P(IgtlProtocol, RefusesTargetsWithoutACalibrationAndForgetsThemAtStartUp) {
  client.command("START_UP");
  EXPECT_EQ(client.command("TARGETING").back(), "STATUS TARGETING 13");
  EXPECT_EQ(client.aim(3.5F), (Script{"TRANSFORM ACK_1", "STATUS TARGET 13"}));
  client.targeted();
  client.command("START_UP");
  EXPECT_EQ(client.protocol.wish().proposal, 0U);
  EXPECT_EQ(client.command("TARGETING").back(), "STATUS TARGETING 13");
}

TEST_P(IgtlProtocol, RefusesACalibrationThatIsNoPose) {
  client.command("START_UP");
  client.command("CALIBRATION");
  Transform ones;
  ones.columns.fill(1.0F);
  EXPECT_EQ(client.calibrate(ones), (Script{"TRANSFORM ACK_1", "STATUS CALIBRATION 10"}));
  EXPECT_NE(client.reason().find("stretches"), std::string::npos) << client.reason();
  Transform far_away;
  far_away.columns[10] = 3'000.0F;
  EXPECT_EQ(client.calibrate(far_away).back(), "STATUS CALIBRATION 10");
  EXPECT_NE(client.reason().find("3000 mm"), std::string::npos) << client.reason();
  EXPECT_EQ(client.command("TARGETING").back(), "STATUS TARGETING 13");
  EXPECT_EQ(client.calibrate(), (Script{"TRANSFORM ACK_1", "STATUS CALIBRATION 13"}));  // not in CALIBRATION
}

TEST_P(IgtlProtocol, RefusesATargetWithTheDistance) {
  client.targeted();
  const auto refused = [&](float depth, float aside, const std::string& why) {
    EXPECT_EQ(client.aim(depth, aside), (Script{"TRANSFORM ACK_1", "STATUS TARGET 10"}));
    EXPECT_NE(client.reason().find(why), std::string::npos) << client.reason();
    EXPECT_EQ(client.protocol.wish().proposal, 0U);
    EXPECT_EQ(client.command("MOVE_TO_TARGET").back(), "STATUS MOVE_TO_TARGET 13");
    client.command("TARGETING");
  };
  refused(3.5F, 2.5F, "2.5 mm off the needle axis");
  refused(5'000.0F, 0.0F, "4989.0 mm beyond the reach of 11.0 mm");
  refused(-3.0F, 0.0F, "3.0 mm behind");
  refused(0.3F, 0.0F, "0.30 mm deep");
  refused(std::numeric_limits<float>::quiet_NaN(), 0.0F, "not a number");
}

TEST_P(IgtlProtocol, PassesOnWhyTheConsoleHasNoPlan) {
  client.targeted();
  client.aim(4.0F);
  client.robot.answered = client.protocol.wish().proposal;
  client.robot.planned = false;
  client.robot.why = "the path leaves the label map";
  EXPECT_EQ(client.wait_ms(1), (Script{"STATUS TARGET 10"}));
  EXPECT_EQ(client.reason(), "the path leaves the label map");
  client.aim(4.0F);  // the answer to the one before is none to this one
  EXPECT_EQ(client.wait_ms(8'900), Script{});
  EXPECT_EQ(client.wait_ms(200), (Script{"STATUS TARGET 7"}));
}

// Depth 0: the tip is where it is wanted before anything moves.
TEST_P(IgtlProtocol, ATargetAtTheTipNeedsNoInsertion) {
  client.targeted();
  EXPECT_EQ(client.aim(0.0F)[1], "STATUS TARGET 1");
  EXPECT_EQ(client.protocol.wish().proposal, 0U);
  const Script moved = client.command("MOVE_TO_TARGET");
  EXPECT_FALSE(client.protocol.wish().motion);
  EXPECT_EQ(moved.back(), "TRANSFORM CURRENT_POSITION");
  EXPECT_NE(std::ranges::find(moved, "STATUS MOVE_TO_TARGET 1"), moved.end());
  client.robot.depth = Millimetres(2.0);  // friction holds it there
  EXPECT_EQ(client.command("MOVE_TO_TARGET").back(), "STATUS MOVE_TO_TARGET 13");
  EXPECT_NE(client.reason().find("withdrawn"), std::string::npos);
}

TEST_P(IgtlProtocol, MovesOnlyWhatWasConfirmedAndArmedByAPerson) {
  const auto refused_because = [&](const std::string& why) {
    const Script answer = client.command("MOVE_TO_TARGET");
    EXPECT_EQ(answer, (Script{"STRING ACK_1 MOVE_TO_TARGET", "STATUS CURRENT_STATUS 1 MOVE_TO_TARGET",
                              "STATUS MOVE_TO_TARGET 13"}));
    EXPECT_NE(client.reason().find(why), std::string::npos) << client.reason();
    EXPECT_FALSE(client.protocol.wish().motion);
  };
  refused_because("START_UP");
  client.command("START_UP");
  refused_because("not calibrated");
  client.command("CALIBRATION");
  client.calibrate();
  refused_because("no target");
  client.targeted();
  refused_because("not confirmed");
  client.robot.confirmed = true;
  client.robot.mode = Mode::Ready;
  client.robot.why = "turn the arm key on the device";
  refused_because("not armed on the device: turn the arm key");
  client.robot.mode = Mode::Armed;
  client.robot.answered = 77;  // the console shows another plan
  refused_because("not confirmed");
  client.robot.answered = client.protocol.wish().proposal;
  client.robot.console = false;
  refused_because("no console");
  client.robot.console = true;
  client.robot.heard = false;
  refused_because("silent");
  client.robot.heard = true;
  EXPECT_EQ(client.command("MOVE_TO_TARGET").back(), "TRANSFORM CURRENT_POSITION");
}

TEST_P(IgtlProtocol, KeepsCalibrationAndTargetWhileTheNeedleIsIn) {
  client.moving();
  const std::uint32_t proposal = client.protocol.wish().proposal;
  EXPECT_EQ(client.command("START_UP").back(), "STATUS START_UP 13");
  client.command("CALIBRATION");
  EXPECT_EQ(client.calibrate().back(), "STATUS CALIBRATION 13");
  client.command("TARGETING");
  EXPECT_EQ(client.aim(2.0F).back(), "STATUS TARGET 13");
  EXPECT_EQ(client.protocol.wish().proposal, proposal);
}

TEST_P(IgtlProtocol, TellsWhereTheTipIs) {
  EXPECT_EQ(client.send({"CURRENT_POSITION", Query::Transform}), (Script{"STATUS CURRENT_POSITION 13"}));
  client.targeted();
  client.robot.depth = Millimetres(2.25);
  EXPECT_EQ(client.send({"CURRENT_POSITION", Query::Transform}), (Script{"TRANSFORM CURRENT_POSITION"}));
  EXPECT_FLOAT_EQ(std::get<Transform>(client.last[0].body).columns[11], 2.25F);
  EXPECT_EQ(client.send({"", Query::Status}), (Script{"STATUS CURRENT_STATUS 1 TARGETING"}));
  EXPECT_NE(client.reason().find("1.25 mm before the target"), std::string::npos) << client.reason();
  const Script asked = client.send({"CMD_9", Text{"CURRENT_POSITION"}});
  EXPECT_EQ(asked, of_2021() ? (Script{"TRANSFORM CURRENT_POSITION"})
                             : (Script{"STRING ACK_9 CURRENT_POSITION",
                                       "STATUS CURRENT_STATUS 12 CURRENT_POSITION"}));
  for (const std::string& behind : {std::string("\r\n"), std::string(1, '\0'), std::string("  ")}) {
    const Script word = client.send({"CMD_3", Text{"CURRENT_POSITION" + behind}});
    EXPECT_EQ(word[0] == "TRANSFORM CURRENT_POSITION", of_2021());
  }
  EXPECT_EQ(client.send({"CURRENT_POSITION", Text{"x"}}),
            of_2021() ? (Script{"TRANSFORM CURRENT_POSITION"}) : (Script{"STATUS CURRENT_STATUS 12 x"}));
  client.robot.measured = false;
  EXPECT_EQ(client.send({"CURRENT_POSITION", Query::Transform}), (Script{"STATUS CURRENT_POSITION 13"}));
}

TEST_P(IgtlProtocol, TellsWhereTheTargetIs) {
  const std::string name = of_2021() ? "REACHABLE_TARGET" : "TARGET";
  EXPECT_EQ(client.send({name, Query::Transform}), (Script{"STATUS " + name + " 13"}));
  client.targeted();
  client.robot.depth = Millimetres(0.75);
  EXPECT_EQ(client.send({name, Query::Transform}), (Script{"TRANSFORM " + name}));
  EXPECT_FLOAT_EQ(std::get<Transform>(client.last[0].body).columns[11], 3.5F);
}

// What is refused while the needle moves takes neither the positions nor the end from who asked for it.
TEST_P(IgtlProtocol, WhatIsRefusedInMotionLeavesItsAnswers) {
  client.moving();
  EXPECT_EQ(client.aim(5.0F), (Script{"TRANSFORM ACK_1", "STATUS TARGET 13"}));
  EXPECT_EQ(client.calibrate(), (Script{"TRANSFORM ACK_1", "STATUS CALIBRATION 13"}));
  EXPECT_EQ(client.command("FASTER").back(), "STATUS CURRENT_STATUS 12 FASTER");
  EXPECT_EQ(client.wait_ms(200), Script(2, "TRANSFORM CURRENT_POSITION"));
  client.robot.mode = Mode::Trip;
  EXPECT_EQ(client.wait_ms(1)[0], "STATUS MOVE_TO_TARGET 3");
}

// US-ASCII that no NUL ends before its end: Latin-1, UTF-8, a terminal's escape, a text cut at a NUL.
TEST_P(IgtlProtocol, WhatCannotBePrintedIsNotSentBackInAStatus) {
  for (const std::string& text : {std::string("M\xC4NUAL"), std::string("\xE2\x82\xAC"),
                                  std::string("\x1b[2J"), std::string("ST\0OP", 5)}) {
    client.send({"CMD_4", Text{text, 106}});
    const auto& told = std::get<Status>(client.last.back().body);
    for (const char letter : told.error_name + told.message) EXPECT_TRUE(letter >= ' ' && letter <= '~');
    EXPECT_NE(told.message.find("known are"), std::string::npos);
  }
}

TEST_P(IgtlProtocol, AnswersWhatItDoesNotKnowWithAReason) {
  const auto told = [&](Message message, const std::string& why) {
    const Script answer = client.send(std::move(message));
    ASSERT_FALSE(answer.empty());
    EXPECT_TRUE(answer.back().starts_with("STATUS CURRENT_STATUS 12")) << answer.back();
    EXPECT_NE(client.reason().find(why), std::string::npos) << client.reason();
  };
  told({"CMD_1", Text{"DANCE"}}, "unknown command 'DANCE'; known are START_UP, PLANNING");
  told({"CMD_1", Text{std::string(60'000, 'x')}}, "unknown command");
  told({"CMD_1", Text{"PLANNING", 1013}}, "encoding 1013");
  told({"XYZ_1", Text{"STOP"}}, "CMD_n");
  told({"XYZ_1", Transform{}}, "CLB_n");
  told({"scan", Image{}}, "images");
  told({"x", Unusable{"POLYDATA", "this robot does not use it"}}, "POLYDATA: this robot");
  EXPECT_EQ(client.send({"x", Status{}}), Script{});  // or two robots would answer each other for ever
}

}  // namespace
}  // namespace biopsy::igtl
