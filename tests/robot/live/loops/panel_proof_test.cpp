// The hand at a simulated panel, by the clock.
#include "robot/live/session/panel_proof.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>

namespace biopsy::loops_tests {
namespace {

// A stage that was not read yet when the panel was first proven: the supervisor says that it does not count.
TEST(PanelProof, IsRepeatedWhereItDidNotCountAndBegunAnewInASession) {
  robot::PanelProof person;
  const digital_io::PanelLevels asked{.estop_a_closed = true, .estop_b_closed = true};
  const auto presses = [&](const Decision& told, std::int64_t from_us) {
    int pressed = 0, turned = 0;
    for (std::int64_t us = from_us; us < from_us + 1'000'000; us += 5'000) {
      const digital_io::PanelLevels now = person.levels(asked, told, us);
      pressed += !now.estop_a_closed && !now.estop_b_closed;
      turned += now.reset_key && now.estop_a_closed;
    }
    return std::pair(pressed, turned);
  };
  EXPECT_EQ(presses({}, 0), std::pair(0, 0)) << "no supervisor yet";
  Decision told;
  told.worst = static_cast<std::uint8_t>(safety::Hazard::None);
  told.session = 3;
  EXPECT_EQ(presses(told, 1'000'000), std::pair(20, 20));
  EXPECT_EQ(presses(told, 2'000'000), std::pair(0, 0)) << "once";
  told.worst = static_cast<std::uint8_t>(safety::Hazard::PanelUntested);
  EXPECT_GE(presses(told, 3'000'000).first, 20);
  told.worst = static_cast<std::uint8_t>(safety::Hazard::None);
  presses(told, 4'000'000);
  told.session = 4;
  EXPECT_EQ(presses(told, 5'000'000), std::pair(20, 20));
}

using digital_io::PanelLevels;

Decision told_by(std::uint32_t session, safety::Hazard worst = safety::Hazard::None) {
  Decision told;
  told.session = session;
  told.epoch = 70;
  told.worst = static_cast<std::uint8_t>(worst);
  told.reason = static_cast<std::uint8_t>(safety::Hazard::None);
  return told;
}

// What the operator's program asks for; nobody turns the arm key meanwhile.
const PanelLevels kAsked{.arm_key = true, .estop_a_closed = true, .estop_b_closed = true};
const PanelLevels kAtRest{.estop_a_closed = true, .estop_b_closed = true};
const PanelLevels kTurned{.reset_key = true, .estop_a_closed = true, .estop_b_closed = true};

TEST(PanelProof, PressesReleasesTurnsAndLetsGoATenthOfASecondEach) {
  for (const std::uint32_t session : {1U, UINT32_MAX}) {
    robot::PanelProof person;
    const auto at = [&](std::int64_t us) { return person.levels(kAsked, told_by(session), 5'000'000 + us); };
    EXPECT_EQ(person.levels(kAsked, told_by(0), 4'000'000), kAsked) << "no supervisor yet";
    EXPECT_EQ(at(0), kAtRest);
    EXPECT_EQ(at(99'999), kAtRest);
    EXPECT_EQ(at(100'000), PanelLevels{});
    EXPECT_EQ(at(150'000), PanelLevels{});
    EXPECT_EQ(at(199'999), PanelLevels{});
    EXPECT_EQ(at(200'000), kAtRest);
    EXPECT_EQ(at(299'999), kAtRest);
    EXPECT_EQ(at(300'000), kTurned);
    EXPECT_EQ(at(350'000), kTurned);
    EXPECT_EQ(at(399'999), kTurned);
    EXPECT_EQ(at(400'000), kAsked);
    EXPECT_EQ(at(9'000'000), kAsked);
  }
}

TEST(PanelProof, BeginsAgainInAnotherSessionOrWhereItDidNotCountButNotBeforeThatIsTold) {
  using safety::Hazard;
  robot::PanelProof person;
  std::int64_t began_us = 5'000'000;
  const auto at = [&](std::int64_t us, const Decision& told) {
    return person.levels(kAsked, told, began_us + us);
  };
  (void)at(0, told_by(9));
  EXPECT_EQ(at(599'999, told_by(9, Hazard::PanelUntested)), kAsked);
  EXPECT_EQ(at(700'000, told_by(9, Hazard::StepDepth)), kAsked) << "another hazard";
  Decision before = told_by(9);
  before.reason = static_cast<std::uint8_t>(Hazard::PanelUntested);
  EXPECT_EQ(at(700'000, before), kAsked) << "it was so once";
  (void)at(800'000, told_by(9));
  for (int n = 0; n < 2; ++n) {
    const std::int64_t again_us = n == 0 ? 900'000 : 600'000;
    EXPECT_EQ(at(again_us, told_by(9, Hazard::PanelUntested)), kAtRest) << n;
    EXPECT_EQ(at(again_us + 100'000, told_by(9, Hazard::PanelUntested)), PanelLevels{});
    EXPECT_EQ(at(again_us + 599'999, told_by(9, Hazard::PanelUntested)), kAsked);
    began_us += again_us;
  }
  for (const std::uint32_t session : {7U, 8U}) {  // with a smaller number, and with a larger one
    began_us += 2'000'000;
    EXPECT_EQ(at(0, told_by(session)), kAtRest) << session;
    EXPECT_EQ(at(100'000, told_by(session)), PanelLevels{});
    EXPECT_EQ(at(400'000, told_by(session)), kAsked);
  }
}

// A turn that fell into a stall of the machine counts for nothing, and the stop that was pressed for the
// proof stays latched. One that comes later is not the proof's, and nobody's to reset without looking.
TEST(PanelProof, IsRepeatedWhileItsOwnStopStandsAndNeverForALaterOne) {
  using safety::Hazard;
  robot::PanelProof person;
  const auto at = [&](std::int64_t us, Hazard worst) { return person.levels(kAsked, told_by(5, worst), us); };
  (void)at(1'000'000, Hazard::EStop);
  EXPECT_EQ(at(1'500'000, Hazard::EStop), kAsked) << "not told yet what became of it";
  EXPECT_EQ(at(1'600'000, Hazard::EStop), kAtRest);
  EXPECT_EQ(at(1'750'000, Hazard::EStop), PanelLevels{});
  EXPECT_EQ(at(1'950'000, Hazard::EStop), kTurned);
  EXPECT_EQ(at(2'200'000, Hazard::PlanUnconfirmed), kAsked);
  for (std::int64_t us = 2'300'000; us < 9'000'000; us += 50'000)
    EXPECT_EQ(at(us, Hazard::EStop), kAsked) << us;
}

TEST(PanelProof, NeverHidesAStopThatIsAskedFor) {
  const PanelLevels stop{.arm_key = true};
  for (std::int64_t us = 0; us < 1'000'000; us += 10'000) {
    robot::PanelProof person;
    (void)person.levels(kAsked, told_by(5), 1'000'000);
    const PanelLevels now = person.levels(stop, told_by(5), 1'000'000 + us);
    EXPECT_FALSE(now.estop_a_closed || now.estop_b_closed) << us;
  }
}

// A contact that does not close shows as itself, in the hand's pauses too.
TEST(PanelProof, ShowsEachContactAsAskedFor) {
  for (const bool a : {false, true}) {
    robot::PanelProof person;
    const PanelLevels asked{.estop_a_closed = a, .estop_b_closed = !a};
    for (const std::int64_t us : {0, 250'000, 350'000, 450'000}) {
      const PanelLevels now = person.levels(asked, told_by(5), 1'000'000 + us);
      EXPECT_EQ(now.estop_a_closed, a) << us;
      EXPECT_EQ(now.estop_b_closed, !a) << us;
    }
  }
}

// The stop of its own proof stands in the new session: that one was not seen released.
TEST(PanelProof, IsRepeatedInANewSessionThoughThatBeforeSawItsStopReleased) {
  using safety::Hazard;
  robot::PanelProof person;
  (void)person.levels(kAsked, told_by(5), 1'000'000);
  (void)person.levels(kAsked, told_by(5), 2'000'000);
  (void)person.levels(kAsked, told_by(6, Hazard::EStop), 3'000'000);
  EXPECT_EQ(person.levels(kAsked, told_by(6, Hazard::EStop), 3'600'000), kAtRest);
  EXPECT_EQ(person.levels(kAsked, told_by(6, Hazard::EStop), 3'700'000), PanelLevels{});
}

}  // namespace
}  // namespace biopsy::loops_tests
