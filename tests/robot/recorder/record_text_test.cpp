// Records in words. Bodies are those of a log that a live run wrote, of an older version of the program, and
// damaged ones.
#include "robot/recorder/record_text.hpp"

#include <gtest/gtest.h>

#include <string>

namespace biopsy::recorder {
namespace {

std::string text(RecordKind kind, const std::string& body) {
  Record record;
  record.kind = name_of(kind);
  record.body = body;
  return text_of(record);
}

TEST(RecordText, SaysWhatHappened) {
  EXPECT_EQ(text(RecordKind::ProcessStart, "{}"), "the log begins");
  EXPECT_EQ(text(RecordKind::ProcessStart, R"({"alive":true,"config":"7ed9","operator":"r.meyer"})"),
            "started, configuration 7ed9, operator r.meyer");
  EXPECT_EQ(
      text(
          RecordKind::StateChange,
          R"({"epoch":1,"event":"step reached","mode":"hold","reason":"none","seq":9385,"session":1,"stage":1,)"
          R"("stage_done":true,"stop":1,"worst":"none"})"),
      "hold: step reached, step 1 done");
  EXPECT_EQ(text(RecordKind::Alarm,
                 R"({"before":"none","seq":170,"worst":"H-25 emergency stop pressed or unread"})"),
            "H-25 emergency stop pressed or unread");
  EXPECT_EQ(text(RecordKind::Alarm,
                 R"({"before":"H-25 emergency stop pressed or unread","seq":640,"worst":"none"})"),
            "over: H-25 emergency stop pressed or unread");
  EXPECT_EQ(text(RecordKind::Alarm, R"({"beside":"H-25 emergency stop pressed","over":false,"seq":700})"),
            "beside it: H-25 emergency stop pressed");
  EXPECT_EQ(text(RecordKind::Alarm, R"({"beside":"H-25 emergency stop pressed","over":true,"seq":800})"),
            "over: H-25 emergency stop pressed");
  EXPECT_EQ(text(RecordKind::PermitChange,
                 R"({"command_kV":0.0,"depth_mm":-0.025,"gate":1,"hv_enabled":true,"seq":755})"),
            "high voltage ON, 0.00 kV commanded, needle at -0.03 mm");
  EXPECT_EQ(text(RecordKind::DepthCheck, R"({"accepted":true,"stage":2})"), "step 2: its depth is accepted");
  EXPECT_EQ(text(RecordKind::DepthCheck, R"({"accepted":false,"stage":2})"), "step 2: no depth is accepted");
  EXPECT_EQ(text(RecordKind::Plan,
                 R"({"confirmations":2,"patient":"PHANTOM","seal":"573db5ea47f18b56b7a7","seal_holds":true,)"
                 R"("series_uid":"2.25","stages":2,"target_mm":3.5})"),
            "plan 573db5ea47f18b56 for patient PHANTOM: target 3.50 mm in 2 steps, 2 of 2 confirmations at "
            "the console");
  EXPECT_EQ(text(RecordKind::Plan, R"({"seal":"00","seal_holds":false})"),
            "a plan whose seal 00 DOES NOT HOLD");
}

TEST(RecordText, SaysWhoDidWhat) {
  const auto act = [](const std::string& more) {
    return text(
        RecordKind::OperatorAct,
        R"({"acquiring":false,"asks_arm":false,"asks_reset":false,"finish":false,"held":false,"stop":0,"token":0)" +
            more + "}");
  };
  EXPECT_EQ(act(""), "asks for nothing") << "an older log has no operator";
  EXPECT_EQ(act(R"(,"operator":"r.meyer")"), "r.meyer asks for nothing");
  EXPECT_EQ(act(R"(,"operator":"r.meyer","held":true,"token":3)"),
            "r.meyer holds the motion button (press 3)");
  EXPECT_EQ(act(R"(,"operator":"r.meyer","stop":3)"), "r.meyer requests stop: off at once (C0)");
  EXPECT_EQ(act(R"(,"operator":"r.meyer","hold_still":true,"acquiring":true)"),
            "r.meyer has the needle locked, has an image taken");
}

TEST(RecordText, SaysWhoConfirmedAPlanAndJudgedADepth) {
  EXPECT_EQ(
      text(RecordKind::Plan,
           R"({"confirmations":2,"operator":"r.meyer","patient":"PHANTOM","seal":"573db5ea47f18b56b7a7",)"
           R"("seal_holds":true,"stages":2,"target_mm":3.5})"),
      "plan 573db5ea47f18b56 for patient PHANTOM: target 3.50 mm in 2 steps, 2 of 2 confirmations at the "
      "console, operator "
      "r.meyer");
  EXPECT_EQ(text(RecordKind::Plan, R"({"operator":"a.b","seal":"00","seal_holds":false})"),
            "a plan whose seal 00 DOES NOT HOLD, operator a.b");
  EXPECT_EQ(text(RecordKind::DepthCheck, R"({"accepted":true,"operator":"r.meyer","stage":2})"),
            "step 2: its depth is accepted, operator r.meyer");
  EXPECT_EQ(text(RecordKind::PlanConfirmation, R"({"operator":"k.shift","seal":"00ab0000000000000011"})"),
            "confirms plan 00ab000000000000 apart from the console, operator k.shift");
}

// A key names nobody: who was signed in at the console then.
TEST(RecordText, SaysWhoWasSignedInWhenAKeyWasTurned) {
  SignedIn signed_in;
  const auto says = [&](const std::string& source, RecordKind kind, const std::string& body) {
    Record record;
    record.source = source;
    record.kind = name_of(kind);
    record.body = body;
    signed_in.follow(record);
    return text_of(record, signed_in.name());
  };
  const auto state = [&](const std::string& event) {
    return says(
        "supervisor", RecordKind::StateChange,
        R"({"event":")" + event + R"(","mode":"armed","reason":"none","stage":1,"stage_done":false})");
  };
  EXPECT_EQ(state("armed on the device"), "armed: armed on the device, step 1") << "nobody is known";
  says("person", RecordKind::ProcessStart, R"({"alive":true,"config":"7ed9","operator":"r.meyer"})");
  EXPECT_EQ(state("armed on the device"), "armed: armed on the device, step 1; signed in: r.meyer");
  EXPECT_EQ(state("reset on the device"), "armed: reset on the device, step 1; signed in: r.meyer");
  EXPECT_EQ(state("motion button pressed"), "armed: motion button pressed, step 1");
  says("stage", RecordKind::ProcessStop, R"({"alive":false})");
  EXPECT_EQ(state("armed on the device"), "armed: armed on the device, step 1; signed in: r.meyer");
  says("person", RecordKind::OperatorAct, R"({"operator":"k.shift","held":false})");
  EXPECT_EQ(state("armed on the device"), "armed: armed on the device, step 1; signed in: k.shift");
  says("confirmer", RecordKind::PlanConfirmation, R"({"operator":"somebody","seal":"00"})");
  EXPECT_EQ(state("armed on the device"), "armed: armed on the device, step 1; signed in: k.shift");
  says("person", RecordKind::DepthCheck, "no JSON");
  EXPECT_EQ(state("armed on the device"), "armed: armed on the device, step 1; signed in: k.shift");
  says("person", RecordKind::ProcessStop, R"({"alive":false,"config":"7ed9"})");
  EXPECT_EQ(state("armed on the device"), "armed: armed on the device, step 1");
}

TEST(RecordText, ShowsABodyThatIsNotWhatItsKindHasAsItStands) {
  for (const RecordKind kind : {RecordKind::StateChange, RecordKind::Plan, RecordKind::OperatorAct,
                                RecordKind::Request, RecordKind::DepthCheck, RecordKind::PermitChange,
                                RecordKind::RequestRefused, RecordKind::PlanConfirmation})
    for (const std::string body : {"no JSON", "[1,2]", "{\"stage\":\"one\"}", "{", "\xff\xfe"}) {
      EXPECT_EQ(text(kind, body), body) << name_of(kind);
    }
  EXPECT_EQ(text(RecordKind::RecordsLost, R"({"lost_records":7,"why":"disk full"})"),
            "lost records 7, why disk full");
}

}  // namespace
}  // namespace biopsy::recorder
