// A full disk: records wait in memory, the backlog grows, and all are written once there is space.
#include <nlohmann/json.hpp>

#include "robot/common/config_error.hpp"
#include "tests/full_disk.hpp"
#include "tests/robot/recorder/log_for_tests.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::recorder {
namespace {

TEST(FullDisk, RecordsWaitWithAGrowingBacklogAndAreAllWrittenWhenSpaceReturns) {
  verifies("R-28");
  const LogFolder folder;
  Recorder recorder(folder.log, folder.key());
  for (std::int64_t n = 1; n <= 20; ++n) recorder.append(entry(n), Urgency::Urgent, n * kMs);
  ASSERT_EQ(recorder.written().count, 20U);
  {
    const FullDisk full(fs::file_size(wal_of(folder.log)) + 10'000);  // one or two transactions more
    for (std::int64_t n = 21; n <= 2000; ++n) {
      recorder.append(entry(n), n % 5 ? Urgency::Grouped : Urgency::Urgent, n * kMs);
      recorder.poll(n * kMs);
    }
    EXPECT_LT(recorder.written().count, 40U);
    EXPECT_GT(recorder.backlog_ms(2000 * kMs), 1000) << "the supervisor's limit";
    EXPECT_FALSE(recorder.last_error().empty());
    EXPECT_FALSE(recorder.flush(2000 * kMs));
    EXPECT_EQ(count_of(folder.verdict()), recorder.written().count) << "what is there is a valid prefix";
  }
  recorder.poll(2000 * kMs + kRetry_us);
  EXPECT_EQ(recorder.backlog_ms(3000 * kMs), 0);
  EXPECT_TRUE(recorder.last_error().empty()) << recorder.last_error();
  EXPECT_EQ(count_of(folder.verdict()), 2000U) << text_of(folder.verdict());
  const auto records = records_of(folder.log, folder.public_key());
  ASSERT_EQ(records.size(), 2000U);
  for (std::int64_t n = 1; n <= 2000; ++n) ASSERT_EQ(records[n - 1].body, entry(n).body);
}

TEST(FullDisk, WhatMemoryCannotHoldIsCountedInItsPlace) {
  const LogFolder folder;
  Recorder recorder(folder.log, folder.key(), 64'000);
  constexpr std::int64_t kLost = 10'000, kAfter = 5;
  {
    const FullDisk full(4096);
    for (std::int64_t n = 1; n <= kLost; ++n)
      recorder.append(entry(n), n % 10 ? Urgency::Grouped : Urgency::Urgent, n * kMs);
  }
  for (std::int64_t n = kLost + 1; n <= kLost + kAfter; ++n)
    recorder.append(entry(n), Urgency::Urgent, (n + 100) * kMs);
  const auto records = records_of(folder.log, folder.public_key());
  ASSERT_EQ(text_of(folder.verdict()), "intact");
  std::size_t kept = 0;
  while (kept < records.size() && records[kept].source != "recorder") {
    EXPECT_EQ(records[kept].body, entry(static_cast<std::int64_t>(kept) + 1).body);
    ++kept;
  }
  ASSERT_GT(kept, 100U);
  // The first record after the disk took again found memory still full: it is the last of the lost.
  ASSERT_EQ(records.size(), kept + 1 + kAfter - 1);
  EXPECT_EQ(records[kept].kind, name_of(RecordKind::RecordsLost));
  const auto lost = nlohmann::json::parse(records[kept].body);
  EXPECT_EQ(lost["records"], kLost + 1 - static_cast<std::int64_t>(kept));
  EXPECT_GT(lost["urgent"], 900);
  EXPECT_EQ(lost["first_us"], (static_cast<std::int64_t>(kept) + 1) * kMs);
  EXPECT_EQ(records.back().body, entry(kLost + kAfter).body);
}

TEST(FullDisk, ASmallRecordDoesNotSlipPastALargeOneThatWasLost) {
  const LogFolder folder;
  Recorder recorder(folder.log, folder.key(), 10'000);
  {
    const FullDisk full(4096);
    recorder.append(entry(1, std::string(8000, 'x')), Urgency::Urgent, 0);
    recorder.append(entry(2, std::string(8000, 'y')), Urgency::Urgent, 0);
    recorder.append(entry(3), Urgency::Grouped, 0);
    EXPECT_FALSE(recorder.flush(0));
  }
  EXPECT_TRUE(recorder.flush(0));
  const auto records = records_of(folder.log, folder.public_key());
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(nlohmann::json::parse(records[1].body)["records"], 2);
}

TEST(FullDisk, ARecordLargerThanMemoryIsCountedAndTheNextIsWritten) {
  const LogFolder folder;
  Recorder recorder(folder.log, folder.key(), 10'000);
  recorder.append(entry(1, std::string(20'000, 'x')), Urgency::Urgent, 0);
  recorder.append(entry(2), Urgency::Urgent, 0);
  const auto records = records_of(folder.log, folder.public_key());
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].kind, name_of(RecordKind::RecordsLost));
  EXPECT_EQ(records[1].body, entry(2).body);
}

TEST(FullDisk, ANewLogThatDoesNotFitIsRefusedAndLeavesNothing) {
  const LogFolder folder;
  {
    const FullDisk full(2000);
    EXPECT_THROW(Recorder(folder.log, folder.key()), ConfigError);
  }
  EXPECT_FALSE(fs::exists(folder.log));
  const auto files = std::distance(fs::directory_iterator(folder.scratch.path()), {});
  EXPECT_EQ(files, 1) << "the key";
}

}  // namespace
}  // namespace biopsy::recorder
