// What a run says of its own time. The ticks are those of a host that lost some, as one live run did (993 of
// a hold of 9.40 s were not received, and its report said 8.72 s), and of one whose stage was started anew.
#include "robot/procedure/run_notes.hpp"

#include <gtest/gtest.h>

#include "robot/procedure/run_metrics.hpp"
#include "robot/report/procedure/report.hpp"
#include "robot/report/procedure/verdict.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

struct NotedRun : testing::Test {
  // One tick at `us` of the stage's clock.
  void tick(std::uint32_t seq, std::int64_t us, Mode mode, bool step_done = false, bool held = false) {
    CycleSample cycle;
    cycle.record.measurement.seq = seq;
    cycle.record.measurement.time_us = us;
    cycle.record.supervisor.permit.mode = mode;
    cycle.record.supervisor.step_done = step_done;
    cycle.record.supervisor.reason = safety::Hazard::None;
    OperatorInputs inputs = OperatorInputs::idle();
    inputs.press.held = held;
    notes.add(cycle, inputs);
  }
  double used(const std::string& limit) {
    for (const report::LimitUse& use : notes.record().limits)
      if (use.name == limit) return use.used;
    return -1.0;
  }

  const ScratchFolder folder;
  const PreparedCase prepared = prepare(read_case("gap"), folder.path());
  RunNotes notes{prepared};
};

TEST_F(NotedRun, HoldsAsLongAsTheClockSaysThoughTicksWereLost) {
  std::uint32_t seq = 1, lost = 0;
  for (; seq <= 100; ++seq) tick(seq, 5'000'000 + seq * 1'000, Mode::Active);
  for (; seq <= 9'500; ++seq) {
    const bool received = seq % 9 != 0 || lost >= 993;
    if (received) tick(seq, 5'000'000 + seq * 1'000, Mode::Hold, true);
    lost += !received;
  }
  tick(seq, 5'000'000 + seq * 1'000, Mode::Retract, true);
  ASSERT_EQ(lost, 993U);
  measure_run(notes.record());
  EXPECT_NEAR(used("longest hold"), 9.400, 0.002);
  EXPECT_EQ(notes.record().lost_ticks, 993U);
  EXPECT_EQ(notes.record().longest_gap_ms, 2.0);
  notes.record().outcome = report::Outcome::Completed;
  const std::string verdict = report::verdict_sentence(notes.record());
  EXPECT_NE(verdict.find("993 of 9501 ticks were not received (10.5 %), the longest gap is 2 ms."),
            std::string::npos)
      << verdict;
}

// A report said "Trip, C0 off: none" after a navigation program's EMERGENCY.
TEST_F(NotedRun, AStopThatSomebodyAskedForIsSaidAsOne) {
  tick(1, 1'000, Mode::Active);
  CycleSample stopped;
  stopped.record.measurement.seq = 2;
  stopped.record.measurement.time_us = 2'000;
  stopped.record.supervisor.permit.mode = Mode::Trip;
  stopped.record.supervisor.permit.stop = StopCategory::C0Off;
  stopped.record.supervisor.reason = safety::Hazard::None;
  stopped.record.supervisor.event = safety::Event::Fault;
  notes.add(stopped, OperatorInputs::idle());
  ASSERT_EQ(notes.record().trips.size(), 1U);
  EXPECT_EQ(notes.record().trips[0].reason, "an immediate stop was asked for");
}

TEST_F(NotedRun, InLockstepNothingIsLostAndTheSentenceIsAsBefore) {
  for (std::uint32_t seq = 1; seq <= 500; ++seq) tick(seq, seq * 1'000, Mode::Active, false, true);
  EXPECT_EQ(notes.record().lost_ticks, 0U);
  EXPECT_EQ(notes.record().longest_gap_ms, 0.0);
  EXPECT_EQ(notes.record().unasked_holds, 0U);
  EXPECT_EQ(notes.record().samples.back().time_ms, 499.0);
  EXPECT_EQ(report::verdict_sentence(notes.record()).find("ticks were not received"), std::string::npos);
}

TEST_F(NotedRun, AHoldWithinAStepIsUnaskedWhereTheButtonIsPressed) {
  std::uint32_t seq = 0;
  const auto next = [&](Mode mode, bool step_done, bool held) {
    ++seq;
    tick(seq, seq * 1'000, mode, step_done, held);
  };
  next(Mode::Active, false, true), next(Mode::Hold, false, false);  // let go
  next(Mode::Active, false, true), next(Mode::Hold, false, true);   // unasked
  next(Mode::Hold, false, true);                                    // still the same
  next(Mode::Active, false, true), next(Mode::Hold, true, true);    // arrived
  EXPECT_EQ(notes.record().unasked_holds, 1U);
}

TEST_F(NotedRun, AStageThatWasStartedAnewGoesOnInTimeAndLosesNothing) {
  tick(7'000, 900'000'000, Mode::Safe);
  tick(7'001, 900'001'000, Mode::Safe);
  tick(1, 40'000, Mode::Safe);
  tick(2, 41'250, Mode::Safe);
  const std::vector<report::Sample>& samples = notes.record().samples;
  ASSERT_EQ(samples.size(), 4U);
  EXPECT_EQ(samples[2].time_ms, 2.0);
  EXPECT_EQ(samples[3].time_ms, 3.25);
  EXPECT_EQ(notes.record().lost_ticks, 0U);
  EXPECT_EQ(notes.record().longest_gap_ms, 1.25);
}

}  // namespace
}  // namespace biopsy::robot
