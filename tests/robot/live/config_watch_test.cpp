// The configuration's files, read again while the robot runs.
#include "robot/live/config_watch.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <set>
#include <thread>
#include <vector>

#include "robot/live/realtime/tick_clock.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::live {
namespace {

TEST(FilesTag, IsKnownForFiveSecondsAfterItWasReadToTheMicrosecond) {
  FilesTag files;
  EXPECT_EQ(files.at(0), 0U) << "never read";
  EXPECT_EQ(files.at(9'000'000), 0U);
  files.set(78, 1);
  EXPECT_EQ(files.at(1), 78U);
  files.set(77, 1'000'000);
  EXPECT_EQ(files.at(1'000'000), 77U);
  EXPECT_EQ(files.at(3'000'000), 77U);
  EXPECT_EQ(files.at(6'000'000), 77U);
  EXPECT_EQ(files.at(6'000'001), 0U);
}

struct ConfigWatchBench : testing::Test {
  ConfigWatchBench() {
    settings.model = folder / "model.toml";
    settings.tissues = folder / "tissues.toml";
    folder.write("model.toml", "v_max = 6000");
    folder.write("tissues.toml", "b = 2");
    folder.write("live.json", to_json(settings));
  }
  std::uint64_t tag() const { return config_tag(folder.path(), settings); }
  static std::int64_t now_us() { return realtime::monotonic_ns() / 1000; }
  // Its thread takes half a second; a busy machine longer.
  static bool within_ten_seconds(const std::function<bool()>& holds) {
    const std::int64_t began_us = now_us();
    while (!holds() && now_us() - began_us < 10'000'000)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return holds();
  }

  const ScratchFolder folder;
  LiveSettings settings;
};

TEST_F(ConfigWatchBench, SeesAFileThatWasEditedRemovedAndPutBack) {
  const std::uint64_t started = tag();
  constexpr std::int64_t kFuture_us = std::int64_t{1} << 60;  // its own thread reads at earlier times
  ConfigWatch watch(folder.path(), settings);
  const auto seen = [&] {
    watch.read(kFuture_us);
    return watch.files().at(kFuture_us);
  };
  EXPECT_EQ(seen(), started);
  folder.write("model.toml", "v_max = 8000");
  EXPECT_NE(seen(), started);
  EXPECT_NE(seen(), 0U);
  std::filesystem::remove(settings.model);
  EXPECT_EQ(seen(), 0U);
  folder.write("model.toml", "v_max = 6000");
  EXPECT_EQ(seen(), started);
}

// Once in three at least: its thread may have read again on a machine that stood still.
TEST_F(ConfigWatchBench, ReadsBeforeTheFirstTickByTheMachinesClock) {
  bool between = false;
  for (int attempt = 0; attempt < 3 && !between; ++attempt) {
    const std::int64_t before_us = now_us();
    const ConfigWatch watch(folder.path(), settings);
    const std::int64_t after_us = now_us();
    between = watch.files().at(before_us + FilesTag::kRead_us) == tag() &&
              watch.files().at(after_us + FilesTag::kRead_us + 1) == 0;
  }
  EXPECT_TRUE(between);
}

TEST_F(ConfigWatchBench, ReadsAgainByItself) {
  const ConfigWatch watch(folder.path(), settings);
  for (const char* text : {"v_max = 8000", "v_max = 7000"}) {
    folder.write("model.toml", text);
    EXPECT_TRUE(within_ten_seconds([&] { return watch.files().at(now_us()) == tag(); })) << text;
  }
}

TEST(FilesTag, SaysWhenItsReadingBeganAndOnceThatItWasAskedFor) {
  FilesTag files;
  EXPECT_EQ(files.read_us(), 0) << "never";
  files.set(77, 1'234'567);
  EXPECT_EQ(files.read_us(), 1'234'567);
  EXPECT_FALSE(files.take_request());
  files.ask();
  EXPECT_TRUE(files.take_request());
  EXPECT_FALSE(files.take_request()) << "taken";
}

// A reading that was asked for began after it was asked for, and does not wait for the next of its own half
// second: of twenty the tenth fastest, on whatever machine.
TEST_F(ConfigWatchBench, ReadsWhereItIsAskedTo) {
  const ConfigWatch watch(folder.path(), settings);
  std::vector<std::int64_t> took_us;
  for (int n = 0; n < 20; ++n) {
    const std::int64_t asked_us = now_us();
    watch.files().ask();
    EXPECT_TRUE(within_ten_seconds([&] { return watch.files().read_us() >= asked_us; })) << n;
    EXPECT_EQ(watch.files().at(now_us()), tag());
    took_us.push_back(now_us() - asked_us);
  }
  std::ranges::sort(took_us);
  EXPECT_LT(took_us[10], 250'000);
}

TEST_F(ConfigWatchBench, ReadsTwiceASecondWhereNobodyAsks) {
  const ConfigWatch watch(folder.path(), settings);
  const std::int64_t began_us = now_us();
  std::set<std::int64_t> readings{watch.files().read_us()};
  EXPECT_TRUE(within_ten_seconds([&] {
    readings.insert(watch.files().read_us());
    return readings.size() >= 4;
  }));
  EXPECT_GT(now_us() - began_us, 1'200'000) << "four readings in less than three half seconds";
}

// It would inherit the priority of the loop that starts it, and files make it wait.
TEST_F(ConfigWatchBench, ReadsOnAThreadOfOrdinaryPriority) {
  const sched_param lowest{.sched_priority = 1}, ordinary{};
  if (sched_setscheduler(0, SCHED_FIFO, &lowest) != 0) GTEST_SKIP() << "no right to a real-time priority";
  const ConfigWatch watch(folder.path(), settings);
  const auto real_time_threads = [] {
    int count = 0;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task"))
      count += sched_getscheduler(std::stoi(task.path().filename())) == SCHED_FIFO ? 1 : 0;
    return count;
  };
  EXPECT_TRUE(within_ten_seconds([&] { return real_time_threads() == 1; })) << "this one";
  sched_setscheduler(0, SCHED_OTHER, &ordinary);
}

}  // namespace
}  // namespace biopsy::live
