// What the tests in real time excuse: delays of this machine, and nothing else; and how a slowed clock
// judges. Inputs: sentences of the supervisor's table and of none of its hazards; the kernel's uptime, which
// no library slows.
#include "tests/robot/live/steady_host.hpp"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "robot/cycle/stop_cause.hpp"

namespace biopsy::live_tests {
namespace {

TEST(SteadyHost, ExcusesAStopThatNamesADelayAndNoOther) {
  for (const safety::HazardFacts& facts : safety::kHazardTable) {
    const bool delay = std::ranges::find(kDelays, facts.hazard) != kDelays.end();
    const std::string kept_by = "the procedure was stopped: " + std::string(facts.name);
    for (const double worst_ms : {19.0, 21.0})
      EXPECT_EQ(names_a_delay(kept_by, worst_ms), delay) << facts.name;
  }
  const std::string stopped = "the procedure was stopped: ";
  const std::string unread = stopped + robot::hazard_text(safety::Hazard::EStop, 21);
  const std::string pressed = stopped + robot::hazard_text(safety::Hazard::EStop, robot::kSeenPressed);
  EXPECT_TRUE(names_a_delay(unread, 21.0));
  EXPECT_FALSE(names_a_delay(unread, 19.0));
  EXPECT_FALSE(names_a_delay(pressed, 21.0)) << "no delay presses a button";
  EXPECT_FALSE(names_a_delay("the robot never got ready: no hazard", 21.0));
}

TEST(SteadyHost, FailsAtOnceForWhatIsNoDelay) {
  static int trials = 0;
  const auto never_ready = [] {
    ++trials;
    return std::string("the robot never got ready");
  };
  EXPECT_NONFATAL_FAILURE(on_a_steady_host(never_ready), "not for a delay");
  EXPECT_EQ(trials, 1);
}

// Moments by hand, in ms; R-24's own rule is claimed where the supervisor's is.
TEST(SteadyHost, SeesThreeShortStallsThatStopARobotTogether) {
  const auto last_of = [](std::vector<double> wakes_ms) {
    LeftOutPeriods periods;
    bool last = false;
    for (const double ms : wakes_ms) last = periods.with(static_cast<std::int64_t>(ms * 1e6));
    return last;
  };
  EXPECT_TRUE(last_of({5, 45, 104}));
  EXPECT_FALSE(last_of({5, 45, 106})) << "the first is over";
  EXPECT_FALSE(last_of({5, 5.4, 60})) << "one stall, felt on two processors";
  EXPECT_FALSE(last_of({5, 45, 60, 70})) << "the fourth is the first of others";
}

double uptime_s() {
  double seconds = 0.0;
  std::ifstream("/proc/uptime") >> seconds;
  return seconds;
}

TEST(SlowedClock, TakesFourTimesAsLong) {
  if constexpr (!can_slow_the_clock()) GTEST_SKIP() << "a sanitizer bears no slowed clock";
  if (!is_clock_slowed()) {
    EXPECT_EQ(repeat_with_slowed_clock(), Repeated::Passed);
    return;
  }
  const double from_s = uptime_s();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // what is measured
  EXPECT_GT(uptime_s() - from_s, 0.35);
}

TEST(SlowedClock, PassesNothingThatFails) {
  if constexpr (!can_slow_the_clock()) GTEST_SKIP() << "a sanitizer bears no slowed clock";
  if (is_clock_slowed()) FAIL() << "as it should here";
  EXPECT_EQ(repeat_with_slowed_clock(), Repeated::Failed);
}

TEST(SlowedClock, PassesNothingThatEndsWithoutAResult) {
  if constexpr (!can_slow_the_clock()) GTEST_SKIP() << "a sanitizer bears no slowed clock";
  if (is_clock_slowed()) std::_Exit(0);
  EXPECT_EQ(repeat_with_slowed_clock(), Repeated::Failed);
}

// What a test of this process sets in the environment is as it was for the next one.
class Environment {
 public:
  explicit Environment(const char* name) : name_(name) {
    if (const char* value = std::getenv(name)) before_ = value;
  }
  ~Environment() { before_ ? set(*before_) : unset(); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  void set(const std::string& value) const { setenv(name_, value.c_str(), 1); }
  void unset() const { unsetenv(name_); }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

// Of all processes of this machine.
int sleeping_for(const std::string& seconds) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc"))
    count += static_cast<int>(read_file_if_present(entry.path() / "cmdline") ==
                              std::string("sleep") + '\0' + seconds + '\0');
  return count;
}

// Of a session of its own, as a robot's processes are, which would hold the names of the next robot.
TEST(SlowedClock, LeavesNoProcessWhereItIsEnded) {
  if constexpr (!can_slow_the_clock()) GTEST_SKIP() << "a sanitizer bears no slowed clock";
  static constexpr const char* kItsOwn = "613.0429";  // s, of no other process
  if (is_clock_slowed()) {
    EXPECT_EQ(std::system(fmt::format("setsid sleep {}", kItsOwn).c_str()), 0);
    return;
  }
  const Environment until("REPEATS_UNTIL");
  until.set(std::to_string(std::time(nullptr) + 3));
  EXPECT_EQ(repeat_with_slowed_clock(), Repeated::Skipped);
  EXPECT_EQ(sleeping_for(kItsOwn), 0);
}

TEST(SlowedClock, StartsNothingOnceTimeIsUp) {
  if constexpr (!can_slow_the_clock()) GTEST_SKIP() << "a sanitizer bears no slowed clock";
  ASSERT_FALSE(is_clock_slowed()) << "it was started";
  const Environment until("REPEATS_UNTIL");
  until.set("1000000000");
  EXPECT_EQ(repeat_with_slowed_clock(), Repeated::Skipped);
}

TEST(SlowedClock, JudgesADeadlineOnlyWhereThatIsAskedFor) {
  const Environment deadlines("SLOWED_DEADLINES");
  deadlines.unset();
  EXPECT_FALSE(can_a_slowed_clock_judge(Asserts::Deadline));
  EXPECT_EQ(can_a_slowed_clock_judge(Asserts::Order), can_slow_the_clock());
  deadlines.set("1");
  EXPECT_EQ(can_a_slowed_clock_judge(Asserts::Deadline), can_slow_the_clock());
}

TEST(SlowedClock, SaysWhatItCouldNotJudgeEither) {
  if constexpr (!can_slow_the_clock()) GTEST_SKIP() << "a sanitizer bears no slowed clock";
  if (is_clock_slowed()) GTEST_SKIP() << "not judged";
  EXPECT_EQ(repeat_with_slowed_clock(), Repeated::Skipped);
}

TEST(SlowedClock, EndsAWaitForACondition) {
  if constexpr (!can_slow_the_clock()) GTEST_SKIP() << "a sanitizer bears no slowed clock";
  if (!is_clock_slowed()) {
    EXPECT_EQ(repeat_with_slowed_clock(), Repeated::Passed);
    return;
  }
  std::mutex mutex;
  std::condition_variable never;
  std::unique_lock lock(mutex);
  const double from_s = uptime_s();
  EXPECT_EQ(never.wait_for(lock, std::chrono::milliseconds(100)), std::cv_status::timeout);
  EXPECT_GT(uptime_s() - from_s, 0.35);
}

}  // namespace
}  // namespace biopsy::live_tests
