// What a run says of its own time. The ticks are those of a host that lost some, as one live run did (993 of
// a hold of 9.40 s were not received, and its report said 8.72 s), and of one whose stage was started anew.
#include "robot/procedure/run_notes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

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

// One image of so many ticks: in which of them the supervisor calls it disturbed, and whether the needle is
// locked without voltage in that tick.
TEST_F(NotedRun, AnImageIsDisturbedByWhatSwitchesOrSlipsInItAndNotByALateMeasurement) {
  std::uint32_t seq = 0;
  const auto disturbed = [&](int first, int count, bool quiet) {
    for (int i = -5; i < 50; ++i) {
      CycleSample cycle;
      cycle.record.measurement.seq = ++seq;
      cycle.record.measurement.time_us = seq * 1'000;
      cycle.record.measurement.brake_on = quiet;
      cycle.record.supervisor.permit.mode = Mode::Hold;
      cycle.record.supervisor.reason = safety::Hazard::None;
      cycle.record.supervisor.step_done = true;
      cycle.record.supervisor.image_disturbed = i >= first && i < first + count;
      OperatorInputs inputs = OperatorInputs::idle();
      inputs.acquiring = i >= 0;
      notes.add(cycle, inputs);
    }
    return notes.record().steps[0].hv_switching_during_image;
  };
  EXPECT_FALSE(disturbed(0, 0, false));
  EXPECT_TRUE(disturbed(20, 1, false)) << "the drive switched";
  EXPECT_FALSE(disturbed(0, 0, false)) << "the next image, of the same step";
  EXPECT_TRUE(disturbed(0, 1, false)) << "in its first tick";
  EXPECT_FALSE(disturbed(-3, 3, false)) << "before it began";
  EXPECT_FALSE(disturbed(20, 3, true)) << "three ticks without a measurement of a locked needle";
  EXPECT_TRUE(disturbed(20, 4, true)) << "it slips";
  EXPECT_TRUE(disturbed(46, 4, true)) << "in its last ticks";
}

// A log showed a hold of 5.33 s, with the brake on but for its first ticks; the report said 0.004 s.
TEST_F(NotedRun, TheLongestHoldIsTheWholeOneWhetherTheNeedleWasLockedInItOrNot) {
  for (const auto& [unlocked_ms, locked_ms, limit_s] :
       {std::tuple(4, 5'326, 180.0), std::tuple(300, 30'000, 180.0), std::tuple(9'000, 0, 10.0)}) {
    RunNotes fresh(prepared);
    std::uint32_t seq = 0;
    const auto add = [&](Mode mode, bool locked, int ticks) {
      for (int i = 0; i < ticks; ++i) {
        CycleSample cycle;
        cycle.record.measurement.seq = ++seq;
        cycle.record.measurement.time_us = seq * 1'000;
        cycle.record.measurement.brake_on = locked;
        cycle.record.supervisor.permit.mode = mode;
        cycle.record.supervisor.reason = safety::Hazard::None;
        fresh.add(cycle, OperatorInputs::idle());
      }
    };
    add(Mode::Active, false, 100), add(Mode::Hold, false, unlocked_ms), add(Mode::Hold, true, locked_ms);
    add(Mode::Active, true, 200), add(Mode::Active, false, 100), add(Mode::Hold, false, 3),
        add(Mode::Safe, false, 100);
    measure_run(fresh.record());
    const auto use_of = [&](const std::string& name) {
      const auto& limits = fresh.record().limits;
      const auto use = std::ranges::find(limits, name, &report::LimitUse::name);
      return use == limits.end() ? report::LimitUse{} : *use;
    };
    EXPECT_NEAR(use_of("longest hold").used, (unlocked_ms + locked_ms) * 1e-3, 1e-6);
    EXPECT_EQ(use_of("longest hold").limit, limit_s);
    if (locked_ms == 0) continue;
    EXPECT_NEAR(use_of("hold without the lock").used, unlocked_ms * 1e-3, 1e-6);
    EXPECT_EQ(use_of("hold without the lock").limit, 10.0);
    EXPECT_NEAR(use_of("needle locked").used, (locked_ms + 200) * 1e-3, 1e-6);
  }
}

// A report must not send a person to the needle with a number that no laser measured.
TEST_F(NotedRun, SaysWhereTheNeedleWasLeftOnlyWhereTheLasersTell) {
  const auto verdict = [&](bool valid, bool valid_b, std::int32_t depth_b_um) {
    RunNotes fresh(prepared);
    for (std::uint32_t seq = 1; seq <= 1'000; ++seq) {
      CycleSample cycle;
      Measurement& m = cycle.record.measurement;
      m.seq = seq, m.time_us = seq * 1'000;
      m.depth_um = 1'500, m.depth_b_um = depth_b_um;
      m.laser_valid = valid, m.laser_b_valid = valid_b;
      cycle.record.supervisor.permit.mode = seq < 500 ? Mode::Active : Mode::Safe;
      cycle.record.supervisor.reason = safety::Hazard::None;
      fresh.add(cycle, OperatorInputs::idle());
    }
    measure_run(fresh.record());
    fresh.record().outcome = report::Outcome::Completed;
    return report::verdict_sentence(fresh.record());
  };
  EXPECT_NE(verdict(true, true, 1'600).find("friction holds the needle 1.50 mm deep"), std::string::npos)
      << verdict(true, true, 1'600);
  for (const std::string& unknown : {verdict(false, true, 1'500), verdict(true, false, 1'500),
                                     verdict(true, true, 1'801), verdict(true, true, -300)}) {
    EXPECT_NE(unknown.find("It is not known where the needle is at 0 V"), std::string::npos) << unknown;
    EXPECT_NE(unknown.find("needle depth unknown"), std::string::npos) << unknown;
  }
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

// One that lasted longer than the supervisor bears is said, though no tick was lost in it; a shorter one is
// not.
TEST_F(NotedRun, SaysALongGapInWhichNoTickWasLost) {
  for (const std::int64_t gap_ms : {2, 5, 6, 267}) {
    RunNotes fresh(prepared);
    for (std::uint32_t seq = 1; seq <= 200; ++seq) {
      CycleSample cycle;
      cycle.record.measurement.seq = seq;
      cycle.record.measurement.time_us = seq * 1'000 + (seq > 100 ? (gap_ms - 1) * 1'000 : 0);
      fresh.add(cycle, OperatorInputs::idle());
    }
    fresh.record().outcome = report::Outcome::Completed;
    const std::string verdict = report::verdict_sentence(fresh.record());
    const std::string says =
        fmt::format("The longest gap between two ticks is {} ms; 5 ms are allowed.", gap_ms);
    EXPECT_EQ(fresh.record().lost_ticks, 0U);
    EXPECT_EQ(verdict.find(says) != std::string::npos, gap_ms > 5) << gap_ms << ": " << verdict;
  }
}

TEST_F(NotedRun, CountsStopsAndLostTicksBeyondItsLastSampleAndSaysWhatIsLeftOut) {
  RunNotes fresh(prepared, 60'000);
  std::uint32_t seq = 1;
  const auto add = [&](Mode mode, safety::Hazard reason) {
    CycleSample cycle;
    cycle.record.measurement.seq = seq;
    cycle.record.measurement.time_us = std::int64_t{seq++} * 1'000;
    cycle.record.supervisor.permit.mode = mode;
    cycle.record.supervisor.reason = reason;
    fresh.add(cycle, OperatorInputs::idle());
  };
  while (seq <= 60'000) add(Mode::Active, safety::Hazard::None);
  EXPECT_EQ(fresh.record().ticks_left_out, 0U);
  EXPECT_EQ(report::verdict_sentence(fresh.record()).find("not kept"), std::string::npos);
  while (seq <= 90'000) add(Mode::Active, safety::Hazard::None);
  seq += 7;
  while (seq <= 100'000) add(Mode::Trip, safety::Hazard::Arc);
  report::RunRecord& record = fresh.record();
  measure_run(record);
  EXPECT_EQ(record.samples.size(), 60'000U);
  EXPECT_EQ(record.ticks_left_out, 39'993U);
  EXPECT_EQ(record.lost_ticks, 7U);
  ASSERT_EQ(record.trips.size(), 1U);
  EXPECT_NEAR(record.trips[0].time_s, 90.007, 1e-6);
  EXPECT_NEAR(record.simulated_s, 100.0, 0.001);
  EXPECT_TRUE(std::isnan(record.left_depth_mm)) << "its end is not known";
  record.outcome = report::Outcome::Completed;
  const std::string verdict = report::verdict_sentence(record);
  EXPECT_NE(verdict.find("7 of 100000 ticks were not received"), std::string::npos) << verdict;
  EXPECT_NE(verdict.find("those of the first 1 min: the last 40 s were not kept"), std::string::npos)
      << verdict;
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
