// A hold as long as a scan: when the brake may take the needle, how long the hold lasts, and that nothing
// moves while an image is taken.
#include <gtest/gtest.h>

#include "safety/types/limits.hpp"
#include "tests/safety/situation.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

TEST(LongHold, TheBrakeMayTakeTheNeedleAtAStepsEndAndKeepItUntilTheDriveCarriesItAgain) {
  verifies("R-54");
  for (std::size_t mode = 0; mode < kModes; ++mode)
    for (const bool done : {false, true})
      for (const bool locked : {false, true})
        for (const bool fitted : {false, true}) {
          Moment moment(static_cast<Mode>(mode));
          moment.input.measurement.brake_fitted = fitted;
          moment.state.step_done = done;
          moment.input.evidence.locked = locked;
          moment.input.motion = {moment.state.token, true};
          const Permit permit = moment.permit();
          const bool held = permit.mode == Mode::Hold || permit.mode == Mode::Active;
          EXPECT_EQ(permit.brake, (permit.mode == Mode::Hold && done && fitted) || (held && locked))
              << name_of(static_cast<Mode>(mode)) << done << locked;
        }
}

TEST(LongHold, EndsAfterTenSecondsUnlessTheNeedleIsLockedAndStill) {
  verifies("R-54");
  Moment moment(Mode::Hold);
  moment.state.ms_in_mode = limits::kHoldMax_ms - 1;
  moment.input.evidence.locked = true;
  EXPECT_EQ(moment.event(), Event::HoldTooLong) << "locked, and slipping";
  moment.input.evidence.still = true;
  EXPECT_EQ(moment.event(), Event::None);
  SupervisorState state = moment.state;
  for (int i = 0; i < 70'000; ++i) {
    moment.state = state;
    state = moment.next();
  }
  EXPECT_EQ(state.mode, Mode::Hold) << "as long as a scan";
  EXPECT_EQ(state.ms_in_mode, limits::kHoldMax_ms) << "and counted no further than anything asks";
  moment.state = state;
  moment.input.evidence.still = false;
  EXPECT_EQ(moment.event(), Event::HoldTooLong) << "at once where it slips then";
}

TEST(LongHold, EndsAfterTenSecondsWhateverTheBrakeDoesWhereSomethingIsWrong) {
  verifies("R-33", "R-54");
  Moment moment(Mode::Hold);
  moment.state.ms_in_mode = limits::kHoldMax_ms - 1;
  moment.input.evidence.locked = moment.input.evidence.still = true;
  EXPECT_EQ(moment.event(), Event::None);
  moment.input.evidence.clear &= ~bit(Hazard::PatientMotion);
  EXPECT_EQ(moment.event(), Event::HoldTooLong);
  moment.input.evidence.clear = kAllHazards;
  moment.input.stop = StopCategory::C2Hold;
  EXPECT_EQ(moment.event(), Event::HoldTooLong);
}

TEST(LongHold, AShortHoldIsNoLongerForBeingStillBefore) {
  verifies("R-54");
  Moment moment(Mode::Hold);
  moment.input.evidence.still = true;
  for (int i = 0; i < 4'000; ++i) moment.state = moment.next();
  moment.input.evidence.still = false;
  int ticks = 0;
  for (; moment.mode() == Mode::Hold; ++ticks) moment.state = moment.next();
  EXPECT_EQ(ticks, 10'000 - 4'000 - 1);
}

TEST(LongHold, NoMotionBeginsWhileAnImageIsTaken) {
  verifies("R-53");
  for (const Mode mode : {Mode::Armed, Mode::Hold}) {
    Moment moment(mode, 11, true);
    EXPECT_EQ(moment.event(), Event::Move);
    moment.input.acquiring = true;
    EXPECT_EQ(moment.event(), Event::None);
    EXPECT_EQ(moment.refusal(), Refusal::ImageRunning);
    EXPECT_EQ(moment.next().token, 11U) << "the press is spent: it does not begin when the image ends";
  }
  EXPECT_EQ(name_of(Refusal::ImageRunning), "an image is being taken");
}

}  // namespace
}  // namespace biopsy::safety
