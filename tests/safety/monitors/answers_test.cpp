// Answers to the challenge of each permit.
#include <gtest/gtest.h>

#include "tests/safety/monitor_bench.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

TEST(LinkMonitor, AnswersMayBeFivePermitsOldAndNotSix) {
  verifies("R-10");
  for (const std::uint32_t age : {0U, 1U, 5U, 6U}) {
    LinkBench bench;
    bench.monitor.answered_seq = bench.seen.permit.seq - 8;
    bench.monitor.answer_score = 1;
    bench.advance();
    bench.answer(bench.seen.permit.seq - age);
    bench.observe();
    EXPECT_EQ(bench.monitor.answer_score, age == 6 ? 3 : 0) << age;
    EXPECT_EQ(bench.names(Hazard::WrongAnswer), age == 6) << age;
  }
}

TEST(LinkMonitor, AnswersOfTheSameNumberAsBeforeAreNeitherNewNorWrong) {
  verifies("R-10");
  LinkBench bench;
  bench.monitor.answer_score = 2;
  const std::uint32_t last = bench.seen.permit.seq;
  bench.advance();
  bench.answer(last);
  bench.observe();
  EXPECT_EQ(bench.monitor.answer_score, 2);
  bench.advance();
  bench.answer(last - 1);
  bench.observe();
  EXPECT_EQ(bench.monitor.answer_score, 4) << "older than one already given";
  EXPECT_EQ(bench.monitor.answered_seq, last);
}

TEST(LinkMonitor, AnswersThatDoNotComeAreWrongAfterFivePermits) {
  verifies("R-10");
  LinkBench bench;
  const Measurement old = bench.seen.measurement;
  for (int silent = 1; silent <= 7; ++silent) {
    bench.advance();
    bench.seen.measurement = old;
    bench.observe();
    EXPECT_EQ(bench.monitor.answer_score, silent < 6 ? 0 : silent == 6 ? 2 : 4) << silent;
  }
}

TEST(LinkMonitor, AnswersAreHeldAgainstTheModeOfThePermitTheyAnswer) {
  verifies("R-10");
  LinkBench bench;
  for (int i = 0; i < 40; ++i) {
    const Mode before = bench.seen.permit.mode;
    bench.advance();
    bench.seen.permit.mode = i % 3 == 0 ? Mode::Hold : Mode::Active;
    const Mode now = bench.seen.permit.mode;
    bench.seen.permit.mode = before;
    bench.answer(bench.seen.permit.seq - 1);
    bench.seen.permit.mode = now;
    bench.observe();
    ASSERT_FALSE(bench.names(Hazard::WrongAnswer)) << i;
    ASSERT_EQ(bench.monitor.answer_score, 0) << i;
  }
}

TEST(LinkMonitor, AnswersAreAllRightUpToTheFirstPermitAndThereIsNoneBefore) {
  LinkBench bench;
  bench.monitor.answered_seq = 0, bench.monitor.answer_score = 0;
  bench.seen.permit.seq = 0;
  bench.tick();
  EXPECT_EQ(bench.monitor.answered_seq, 1U) << "permit 1 was answered";
  bench.monitor.answered_seq = 0;
  bench.advance();
  bench.answer(0);
  bench.observe();
  EXPECT_EQ(bench.monitor.answer_score, 2) << "number 0 answers nothing";
  bench.seen.permit.seq = 0;
  bench.observe();
  EXPECT_TRUE(bench.names(Hazard::WrongAnswer));
}

TEST(LinkMonitor, ChallengeNothingIsProvenBeforeTheFirstPermit) {
  verifies("R-10");
  LinkMonitor monitor;
  monitor.answer_score = 0;
  EXPECT_NE(update(three_step_plan(), monitor, SupervisorInputs{}).found & bit(Hazard::WrongAnswer), 0U);
}

TEST(Challenge, EveryPartOfTheAnswerMatters) {
  verifies("R-10");
  const std::uint32_t right = answer_to(1, 5'000'000, Mode::Active, 77);
  EXPECT_NE(right, answer_to(2, 5'000'000, Mode::Active, 77));
  EXPECT_NE(right, answer_to(1, -5'000'000, Mode::Active, 77));
  EXPECT_NE(right, answer_to(1, 5'000'000, Mode::Hold, 77));
  EXPECT_NE(right, answer_to(1, 5'000'000, Mode::Active, 78));
  EXPECT_NE(challenge_of(1, 5), challenge_of(1, 6));
  EXPECT_NE(challenge_of(1, 5), challenge_of(2, 5));
}

TEST(Challenge, MixesAsTheFinaliserOfMurmurHash3Does) {
  EXPECT_EQ(mix(0), 0U);
  EXPECT_EQ(mix(1), 0x514E'28B7U);
  EXPECT_EQ(mix(2), 0x30F4'C306U);
  EXPECT_EQ(mix(0x1234'5678), 0xE37C'D1BCU);
  EXPECT_EQ(mix(0xFFFF'FFFF), 0x81F1'6F39U);
}

}  // namespace
}  // namespace biopsy::safety
