// The healthy run itself: an hour in stages at every drive, with noise and polarity changes of up to 2 x 7.5
// kV. Too long to try on every mutant (tests/verification/mutation leaves this file out).
#include <gtest/gtest.h>

#include "tests/safety/rig.hpp"

namespace biopsy::safety {
namespace {

TEST(Nuisance, AnHourOfHealthyProceduresStopsForNothing) {
  Rig rig(11);
  rig.depth_accepted = true;
  int moves = 0;
  for (int procedure = 0; procedure < 400; ++procedure) {
    ASSERT_TRUE(rig.go_armed()) << name_of(rig.output.worst);
    for (int stage = 0; stage < 3; ++stage, ++moves) {
      rig.wanted_mV = 3'000'000 + 1'000'000 * stage + 10'000 * (procedure % 100);
      rig.press();
      rig.run(2'500);
      ASSERT_EQ(rig.state.mode, Mode::Active) << name_of(rig.state.reason) << name_of(rig.state.last_event);
      rig.reached = true;
      rig.run(2);
      rig.reached = false;
      rig.run(400);
      ASSERT_EQ(rig.state.mode, Mode::Hold) << name_of(rig.state.reason);
    }
    rig.release();
    rig.finished = true;
    rig.run(2);
    rig.finished = false;
    ASSERT_LT(rig.ticks_until([&] { return rig.state.mode == Mode::Ready; }, 600), 600)
        << name_of(rig.output.worst);
    rig.run(600);
    ASSERT_EQ(rig.state.mode, Mode::Ready) << name_of(rig.output.worst);
  }
  EXPECT_EQ(moves, 1'200);
}

}  // namespace
}  // namespace biopsy::safety
