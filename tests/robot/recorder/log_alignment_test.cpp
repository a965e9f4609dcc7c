// Where a run lies in its log: sequences made at random (seeded), with a known offset.
#include "robot/recorder/log_alignment.hpp"

#include <gtest/gtest.h>

#include <random>

namespace biopsy::recorder {
namespace {

constexpr std::int64_t kSecond_us = 1'000'000;

// Changes at random times, at least 5 ms apart, never into the state that there was.
std::vector<ModeChange> changes(std::mt19937& random, int count, std::int64_t from_us) {
  std::vector<ModeChange> made;
  std::int64_t at_us = from_us;
  int mode = 0;
  for (int n = 0; n < count; ++n) {
    at_us += std::uniform_int_distribution<std::int64_t>(5'000, 20 * kSecond_us)(random);
    mode = (mode + std::uniform_int_distribution<int>(1, 8)(random)) % 9;
    made.push_back({at_us, static_cast<Mode>(mode)});
  }
  return made;
}

std::vector<ModeChange> moved(std::vector<ModeChange> all, std::int64_t by_us, std::mt19937& random,
                              std::int64_t jitter_us) {
  for (ModeChange& one : all)
    one.at_us += by_us + std::uniform_int_distribution<std::int64_t>(0, jitter_us)(random);
  return all;
}

TEST(LogAlignment, FindsTheOffsetAmongOtherRunsWithJitterAndLosses) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937 random(seed);
    std::vector<ModeChange> run = changes(random, 12, 0);
    const std::int64_t offset_us =
        std::uniform_int_distribution<std::int64_t>(0, 1'000'000 * kSecond_us)(random);
    std::vector<ModeChange> log = changes(random, 20, offset_us - 500 * kSecond_us);  // other runs before,
    for (const ModeChange& own : moved(run, offset_us, random, 15'000)) log.push_back(own);
    for (const ModeChange& other : changes(random, 20, offset_us + 300 * kSecond_us)) log.push_back(other);
    log.erase(log.end() - 25);  // of the run itself: its fourth last
    run.erase(run.begin() + 2);
    const auto found = align(run, log);
    ASSERT_TRUE(found.has_value()) << seed;
    EXPECT_GE(found->matched, 9U) << seed;
    EXPECT_GE(found->zero_us, offset_us) << seed;
    EXPECT_LE(found->zero_us, offset_us + 15'000) << seed;
    EXPECT_LE(found->spread_us, kSpreadMax_us) << seed;
  }
}

TEST(LogAlignment, IsNoneWhereFewerThanTwoChangesAgree) {
  const std::vector<ModeChange> run{{1 * kSecond_us, Mode::Ready}, {5 * kSecond_us, Mode::Armed}};
  EXPECT_FALSE(align(run, {}).has_value());
  EXPECT_FALSE(align({}, run).has_value());
  EXPECT_FALSE(align(run, {{1 * kSecond_us, Mode::Ready}}).has_value());
  EXPECT_FALSE(align(run, {{1 * kSecond_us, Mode::Ready}, {6 * kSecond_us, Mode::Armed}}).has_value());
  EXPECT_FALSE(align(run, {{1 * kSecond_us, Mode::Hold}, {5 * kSecond_us, Mode::Trip}}).has_value());
  EXPECT_TRUE(align(run, {{3 * kSecond_us, Mode::Ready}, {7 * kSecond_us, Mode::Armed}}).has_value());
}

TEST(LogAlignment, CountsAChangeOnceHoweverOftenTheLogRepeatsIt) {
  const std::vector<ModeChange> run{{0, Mode::Ready}, {5 * kSecond_us, Mode::Armed}};
  std::vector<ModeChange> log;
  for (int n = 0; n < 50; ++n) log.push_back({n * 1'000, Mode::Ready});
  EXPECT_FALSE(align(run, log).has_value());
}

TEST(LogAlignment, OfTwoPlacesAsGoodTakesTheOneWithLessSpread) {
  const std::vector<ModeChange> run{{0, Mode::Ready}, {5 * kSecond_us, Mode::Armed}};
  const auto found = align(run, {{100 * kSecond_us, Mode::Ready},
                                 {105 * kSecond_us + 40'000, Mode::Armed},
                                 {200 * kSecond_us, Mode::Ready},
                                 {205 * kSecond_us + 1'000, Mode::Armed},
                                 {300 * kSecond_us, Mode::Ready},
                                 {305 * kSecond_us + 60'000, Mode::Armed}});
  ASSERT_TRUE(found.has_value());
  EXPECT_GE(found->zero_us, 200 * kSecond_us);
  EXPECT_LE(found->zero_us, 200 * kSecond_us + 1'000);
}

}  // namespace
}  // namespace biopsy::recorder
