// Claims about a robot in real time, on a machine that may stand still.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>

#include "safety/types/hazards.hpp"
#include "tests/robot/live/host_watch.hpp"
#include "tests/robot/live/slowed_clock.hpp"

namespace biopsy::live_tests {

// What a trial asserts of time: that things come in their order, which holds at any speed of the clock; or a
// deadline, or what the processors bear: of that a slowed clock shows only what the programs do, and it
// judges where SLOWED_DEADLINES is set (`./dev test`, which names what was judged so), for the safety case
// never.
enum class Asserts { Order, Deadline };

inline bool can_a_slowed_clock_judge(Asserts asserts) {
  return can_slow_the_clock() && (asserts == Asserts::Order || std::getenv("SLOWED_DEADLINES") != nullptr);
}

constexpr int kTrials = 4;
constexpr int kTrialsInRealTime = 2;  // where a slowed clock can judge too, which has one at each speed
constexpr int kHopeless = 3;          // stalls in one trial: another meets none in one case of twenty
// A machine also stands still for one process alone, where its own host must first fetch a page of memory:
// no clock beside it sees that.
constexpr int kUnseenStalls = 1;

constexpr std::string_view kNotInTime = "not in time";

// What a machine that stands still can make of a healthy robot: something came late, or not at all.
constexpr std::array kDelays{safety::Hazard::ClockJump,        safety::Hazard::WrongAnswer,
                             safety::Hazard::ControllerSilent, safety::Hazard::SensorStale,
                             safety::Hazard::LoopOverrun,      safety::Hazard::MessageOrder,
                             safety::Hazard::LogBacklog};
// A panel that was not read for 20 ms counts as an emergency stop: only so long a stall explains one.
constexpr double kPanelUnread_ms = 20.0;
constexpr std::string_view kUnread = "emergency stop unread";

inline bool names_a_delay(const std::string& kept_by, double worst_ms) {
  if (worst_ms > kPanelUnread_ms && kept_by.find(kUnread) != std::string::npos) return true;
  return kept_by.starts_with(kNotInTime) || std::ranges::any_of(kDelays, [&](safety::Hazard hazard) {
           return kept_by.find(safety::name_of(hazard)) != std::string::npos;
         });
}

// A trial says what kept it from its claim, empty if nothing did: the robot stopped on its way, as it should
// where its machine stands still. It is tried again where it stopped for a delay and the machine stood still
// meanwhile, and once where no clock saw that; the second time it fails. Any other reason fails at once. Kept
// away in every trial, the test is repeated with a slowed clock if that can judge it; kept away there too, it
// is skipped and says so. What the trial expects is never excused: a failure counts at once.
// True where a trial met its claim in this process.
template <class Trial>
bool on_a_steady_host(Asserts asserts, const Trial& trial) {
  const bool two_clocks = can_a_slowed_clock_judge(asserts);
  std::string told;
  const int unseen_before = is_clock_slowest() ? kUnseenStalls : 0;  // at another speed
  const int trials = is_clock_slowed() ? 1 : two_clocks ? kTrialsInRealTime : kTrials;
  for (int n = 0, unseen = unseen_before; n < trials; ++n) {
    const HostWatch host;
    const std::string kept_by = trial();
    if (::testing::Test::HasFailure()) return false;
    if (kept_by.empty()) return true;
    const std::string trial_told =
        fmt::format("trial {}, this machine {} ({:.1f} ms late at most): {}\n", n + 1,
                    host.stalls() > 0 ? "stood still" : "was steady", host.worst_ms(), kept_by);
    fmt::print("{}", trial_told);
    told += trial_told;
    if (!names_a_delay(kept_by, host.worst_ms())) {
      ADD_FAILURE() << "not for a delay: " << told;
      return false;
    }
    if (two_clocks && !is_clock_slowed() && host.stalls() >= kHopeless) break;
    if (host.stalls() > 0) continue;
    ::testing::Test::RecordProperty("stopped_on_a_steady_host", ++unseen);
    if (unseen > kUnseenStalls) {
      ADD_FAILURE() << told;
      return false;
    }
  }
  const Repeated repeated = two_clocks && !is_clock_slowed() ? repeat_with_slowed_clock() : Repeated::Skipped;
  if (repeated == Repeated::Skipped) {
    [&] { GTEST_SKIP() << "not judged:\n" << told; }();
  } else {
    EXPECT_EQ(repeated, Repeated::Passed) << kJudgedWithSlowedClock;
  }
  return false;
}

template <class Trial>
bool on_a_steady_host(const Trial& trial) {
  return on_a_steady_host(Asserts::Order, trial);
}

}  // namespace biopsy::live_tests
