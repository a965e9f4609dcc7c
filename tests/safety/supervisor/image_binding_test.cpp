// An accepted image lets the needle go on only from the very hold in which it was taken. Reported: an image
// that was accepted before a hold ran out would have served the next insertion as well.
#include <gtest/gtest.h>

#include "tests/safety/situation.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

// In Hold at the end of the second step, reached with permit 60; the button is pressed anew.
struct StepsEnd : Moment {
  StepsEnd(std::uint32_t session, std::uint32_t since_seq) : Moment(Mode::Hold, 11, true) {
    state.step = 1, state.step_done = true;
    state.arrived_seq = 60;
    input.depth_accepted = true, input.accepted_step = 1;
    input.accepted_session = session;
    input.accepted_since_seq = since_seq;
  }
};

TEST(ImageBinding, AnImageThatWasBegunAfterTheArrivalLetsTheNeedleGoOn) {
  verifies("R-67");
  for (const std::uint32_t since_seq : {60U, 61U, 69U})
    EXPECT_EQ(StepsEnd(3, since_seq).event(), Event::Move);
}

TEST(ImageBinding, AnImageFromBeforeTheArrivalOrOfAnotherSessionOrOfNoneDoesNot) {
  verifies("R-67");
  for (const auto& [session, since_seq] :
       {std::pair{3U, 59U}, {3U, 1U}, {3U, 0U}, {2U, 65U}, {4U, 65U}, {0U, 65U}}) {
    StepsEnd end(session, since_seq);
    EXPECT_EQ(end.event(), Event::None) << session << ' ' << since_seq;
    EXPECT_EQ(end.refusal(), Refusal::DepthNotAccepted) << session << ' ' << since_seq;
  }
}

// Reported: a number far ahead would have served every step of the session.
TEST(ImageBinding, AnImageOfTheFutureDoesNot) {
  verifies("R-67");
  EXPECT_EQ(StepsEnd(3, 70).event(), Event::Move) << "in this very tick";
  for (const std::uint32_t since_seq : {71U, 1'000U, 0x7FFF'FFFFU, 0xFFFF'FFFFU}) {
    StepsEnd end(3, since_seq);
    EXPECT_EQ(end.event(), Event::None) << since_seq;
    EXPECT_EQ(end.refusal(), Refusal::DepthNotAccepted) << since_seq;
  }
}

TEST(ImageBinding, AStepThatWasNeverReachedAcceptsNoImage) {
  StepsEnd end(3, 65);
  end.state.arrived_seq = 0;
  EXPECT_EQ(end.refusal(), Refusal::DepthNotAccepted);
}

TEST(ImageBinding, ReachingAStepNotesThePermitOfItsTickAndNothingElseDoes) {
  verifies("R-67");
  Moment reached(Mode::Active, 10, true);
  reached.state.arrived_seq = 12;
  reached.input.request.step_reached = true;
  reached.input.request.step = reached.state.step;
  EXPECT_EQ(reached.next().arrived_seq, 71U);
  reached.input.request.step_reached = false;
  EXPECT_EQ(reached.next().arrived_seq, 12U);
  reached.input.stop = StopCategory::C2Hold;
  EXPECT_EQ(reached.next().arrived_seq, 12U) << "a hold within a step";
}

// The hold runs out with its image accepted, the needle returns, is armed again and driven to the same step.
TEST(ImageBinding, AnImageOfAnEarlierInsertionDoesNotServeTheNext) {
  verifies("R-67");
  StepsEnd end(3, 65);
  end.state.arrived_seq = 500;  // as the second insertion leaves it
  end.state.seq = 900;
  EXPECT_EQ(end.refusal(), Refusal::DepthNotAccepted);
}

}  // namespace
}  // namespace biopsy::safety
