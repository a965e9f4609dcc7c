// What the tests in real time excuse: delays of this machine, and nothing else. Inputs: sentences of the
// supervisor's table and of none of its hazards.
#include "tests/robot/live/steady_host.hpp"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace biopsy::live_tests
