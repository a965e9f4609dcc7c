// The health of a process, as it is sent and as it is read.
#include "robot/live/heartbeat.hpp"

#include <fmt/format.h>

#include "tests/robot/live/loops/bench.hpp"

namespace biopsy::loops_tests {
namespace {

struct HeartbeatBench : LoopBench {
  Health beat(std::int64_t us) {
    heart.beat(kStart_us + us);
    const std::vector<Health> sent = fake_bus::written<Health>();
    return sent.empty() ? Health{} : sent.back();
  }
  live::Heartbeat heart{bus, Process::Stage, kConfig};
};

TEST_F(HeartbeatBench, BeatsEveryTenthOfASecond) {
  EXPECT_EQ(beat(0).seq, 1U);
  EXPECT_EQ(beat(99'999).seq, 0U);
  EXPECT_EQ(beat(100'000).seq, 2U);
  EXPECT_EQ(beat(200'000).seq, 3U);
}

TEST_F(HeartbeatBench, TellsMedianTailAndWorstEachInItsField) {
  for (int us = 1; us <= 100; ++us) heart.lateness().record(1'000 * us);
  heart.lateness().record(5'000'000);
  const Health health = beat(0);
  EXPECT_EQ(health.late_p50_us, 51);
  EXPECT_EQ(health.late_p99_us, 100);
  EXPECT_EQ(health.late_max_us, 5'000);
  heart.lateness().record(INT64_MAX);
  EXPECT_EQ(beat(100'000).late_max_us, INT32_MAX);
}

TEST_F(HeartbeatBench, TellsTheFirstHundredAndTwentyCharactersOfANote) {
  heart.note(fmt::format("{}bc", std::string(119, 'a')));
  EXPECT_EQ(beat(0).note, fmt::format("{}b", std::string(119, 'a')));
  EXPECT_GE(heart.health().note.capacity(), 120U);
  heart.note("short");
  EXPECT_EQ(beat(100'000).note, "short");
}

TEST_F(HeartbeatBench, TellsHowManyMessagesWereRefusedSoFar) {
  for (const std::uint32_t refused : {0U, 5U, 7U}) {
    fake_bus::state().unauthenticated = refused;
    EXPECT_EQ(beat(100'000 * (1 + refused)).refused, refused);
  }
}

TEST_F(HeartbeatBench, HasRoomForANoteBeforeItIsTold) {
  EXPECT_GE(heart.health().note.capacity(), 120U);
}

TEST_F(HeartbeatBench, OfAnotherCountsForHalfASecondToTheMicrosecond) {
  live::HealthBoard board(bus);
  Health health;
  health.process = Process::Controller, health.seq = 3;
  EXPECT_EQ(board.of(Process::Controller, 1).seq, 0U) << "never heard";
  EXPECT_EQ(board.of(Process::Controller, 1).process, Process::Controller);
  fake_bus::put(health);
  board.update(kStart_us);
  EXPECT_EQ(board.of(Process::Controller, kStart_us + 500'000), health);
  EXPECT_EQ(board.of(Process::Controller, kStart_us + 500'001).seq, 0U);
  health.seq = 1;  // it was started again
  fake_bus::put(health);
  board.update(kStart_us + 600'000);
  EXPECT_EQ(board.of(Process::Controller, kStart_us + 600'000), health);
  EXPECT_EQ(board.of(Process::Stage, kStart_us).process, Process::Stage);
  EXPECT_EQ(board.of(Process::Stage, kStart_us).seq, 0U);
}

}  // namespace
}  // namespace biopsy::loops_tests
