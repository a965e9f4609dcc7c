// What a control tick may do to leave a message.
#include "robot/common/logging/tick_log.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "robot/common/logging/log_session.hpp"
#include "tests/robot/live/realtime/counting_allocator.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::logging {
namespace {

constexpr TickEvent kOverrun{Level::Warning, "{0:.0f} periods missed, {1:.1f} us late"};

TEST(TickQueue, GivesRecordsInOrderAndCountsWhatItCannotHold) {
  TickQueue queue;
  TickRecord record;
  EXPECT_FALSE(queue.pop(record));
  for (std::size_t n = 0; n < TickQueue::kCapacity + 10; ++n)
    EXPECT_EQ(queue.push({&kOverrun, static_cast<std::int64_t>(n), {}}), n < TickQueue::kCapacity);
  EXPECT_EQ(queue.dropped(), 10U);
  for (std::size_t n = 0; n < TickQueue::kCapacity; ++n) {
    ASSERT_TRUE(queue.pop(record));
    EXPECT_EQ(record.time_us, static_cast<std::int64_t>(n));
  }
  EXPECT_FALSE(queue.pop(record));
}

TEST(TickQueue, LosesNothingUncountedBetweenTwoThreads) {
  constexpr std::int64_t kRecords = 200'000;
  TickQueue queue;
  std::jthread tick([&queue] {
    for (std::int64_t n = 1; n <= kRecords; ++n)
      queue.push({&kOverrun, n, {static_cast<double>(n), 0, 0, 0}});
  });
  std::int64_t popped = 0, last = 0;
  for (TickRecord record; popped + static_cast<std::int64_t>(queue.dropped()) < kRecords;) {
    if (!queue.pop(record)) continue;
    ASSERT_GT(record.time_us, last);
    ASSERT_EQ(record.values[0], static_cast<double>(record.time_us)) << "a record is whole";
    last = record.time_us;
    ++popped;
  }
  EXPECT_GT(popped, 0);
}

TEST(TickLog, AllocatesNothingInTheTickAndLogsWithTheTimeOfTheTick) {
  const ScratchFolder folder;
  LogSettings settings;
  settings.file = folder / "stage.log";
  settings.level = Level::Info;
  settings.stream = ::open("/dev/null", O_WRONLY);
  const auto now_us = std::chrono::duration_cast<std::chrono::microseconds>(
                          std::chrono::steady_clock::now().time_since_epoch())
                          .count();
  {
    const LogSession session(settings);
    TickLog log(Component::Stage);
    const realtime::AllocationCount allocations;
    log.record(kOverrun, now_us - 3'600'000'000, 3.0, 12.34);
    for (int n = 0; n < 1'000; ++n) log.record(kOverrun, now_us, 1.0);
    EXPECT_EQ(allocations.so_far(), 0U);
  }
  ::close(settings.stream);
  const std::string text = file_content(settings.file);
  EXPECT_NE(text.find("warning stage      3 periods missed, 12.3 us late"), std::string::npos) << text;
  const std::string hour_of_first = text.substr(0, 13);
  EXPECT_NE(hour_of_first, text.substr(text.find('\n') + 1, 13)) << "an hour apart";
}

}  // namespace
}  // namespace biopsy::logging
