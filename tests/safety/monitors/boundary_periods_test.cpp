// Periods that controller or stage let go by, at the edges of the limit.
#include <gtest/gtest.h>

#include "tests/safety/link_bench.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

using Bench = LinkBench;

TEST(Controller, MayMissTwoPeriodsWithinAHundredTicksAndNotThree) {
  verifies("R-24");
  Bench bench;
  const auto miss = [&](std::uint32_t periods) { bench.seen.request.overruns += periods, bench.tick(); };
  miss(2);
  EXPECT_FALSE(bench.names(Hazard::LoopOverrun));
  EXPECT_EQ(bench.watch.miss_score, 199);
  miss(1);
  EXPECT_TRUE(bench.names(Hazard::LoopOverrun));
  EXPECT_EQ(bench.watch.miss_score, 298);
  miss(2);
  EXPECT_EQ(bench.watch.miss_score, 399) << "bounded";
  Bench three;
  three.seen.request.overruns += 3, three.tick();
  EXPECT_EQ(three.watch.miss_score, 399);
  Bench slow;
  slow.watch.miss_score = 1;
  slow.tick();
  EXPECT_EQ(slow.watch.miss_score, 0);
  slow.tick();
  EXPECT_EQ(slow.watch.miss_score, 0);
}

TEST(Stage, MayLeaveOutPeriodsTwiceWithinAHundredTicksAndNotThreeTimes) {
  verifies("R-24");
  const auto step = [](Bench& bench, std::int64_t step_us) {
    bench.seen.measurement.time_us += step_us - 1'000, bench.seen.now_us += step_us - 1'000;
    bench.tick();
  };
  const auto score_after = [&](std::int64_t step_us) {
    Bench bench;
    step(bench, step_us);
    return bench.watch.miss_score;
  };
  EXPECT_EQ(score_after(1), 0);
  EXPECT_EQ(score_after(1'749), 0) << "late, and the next tick still had its own period";
  EXPECT_EQ(score_after(1'750), 99);
  EXPECT_EQ(score_after(5'000), 99) << "one stall, however long: that is R-18's";
  EXPECT_EQ(score_after(5'001), 0) << "a jump of the clock says nothing of periods";
  Bench bench;
  for (int i = 0; i < 2; ++i) step(bench, 2'000);
  EXPECT_FALSE(bench.names(Hazard::LoopOverrun));
  step(bench, 2'000);
  EXPECT_TRUE(bench.names(Hazard::LoopOverrun)) << "500 Hz";
}

TEST(Stage, MissesNoPeriodByALostMessageOrBeforeItsFirst) {
  verifies("R-24");
  Bench lost;
  ++lost.seen.measurement.seq, lost.seen.measurement.time_us += 2'000;
  lost.tick();
  EXPECT_EQ(lost.watch.miss_score, 0) << "the loss is counted where messages are";
  Bench first;
  first.watch.seq = 0, first.seen.measurement.seq = 0, first.seen.measurement.time_us += 3'000;
  first.tick();
  EXPECT_EQ(first.watch.miss_score, 0);
}

TEST(Controller, CountsItsFirstRequestAsTheBeginning) {
  Bench bench;
  bench.watch.request_seq = 0;
  bench.seen.request.overruns = 50;
  bench.tick();
  EXPECT_EQ(bench.watch.miss_score, 0);
  EXPECT_EQ(bench.watch.overruns, 50U);
  bench.watch.request_seq = bench.seen.request.seq = 1, bench.seen.request.overruns = 52;
  bench.tick();
  EXPECT_EQ(bench.watch.miss_score, 199) << "after number 1 it counts";
}

}  // namespace
}  // namespace biopsy::safety
