// How the supervisor's monitors detect the driver's errors.
#include <gtest/gtest.h>

#include "safety/monitors/evidence.hpp"
#include "tests/drivers/contract/driven_stage.hpp"
#include "tests/drivers/nidaqmx/fake_board_config.hpp"

namespace biopsy::nidaqmx {
namespace {

using safety::Hazard;

class NidaqmxMonitors : public testing::Test {
 protected:
  void SetUp() override { see(50); }

  // After so many ticks at 2 kV.
  safety::HazardSet see(int ticks) {
    safety::Evidence evidence;
    for (int k = 0; k < ticks; ++k) {
      safety::SupervisorInputs seen;
      seen.now_us = ++ticks_ * 1'000;
      seen.measurement = driven_.tick(2'000'000);
      evidence = safety::assess({}, memory_, seen);
    }
    return evidence.hazards();
  }
  bool sees(Hazard hazard, int ticks) { return (see(ticks) & safety::bit(hazard)) != 0; }

  fake::Board& board_ = *fake_reset();
  NidaqmxStage stage_{laboratory(), fake_now_us};
  DrivenStage driven_{stage_};
  safety::EvidenceMemory memory_;
  std::int64_t ticks_ = 0;
};

TEST_F(NidaqmxMonitors, HealthyTicksAreNeitherDropoutNorJump) {
  EXPECT_EQ(see(1) & (safety::bit(Hazard::LaserDropout) | safety::bit(Hazard::ClockJump)), 0U);
}

TEST_F(NidaqmxMonitors, ThirdMissedReadingIsADropout) {
  fake_fail("DAQmxReadAnalogF64", -200284, 2);
  EXPECT_FALSE(sees(Hazard::LaserDropout, 2));
  EXPECT_FALSE(sees(Hazard::ClockJump, 1));
  fake_fail("DAQmxReadAnalogF64", -200284, 3);
  EXPECT_TRUE(sees(Hazard::LaserDropout, 3));
}

TEST_F(NidaqmxMonitors, BoardThatIsGoneIsABrokenClockAtOnce) {
  fake_fail("DAQmxReadAnalogF64", -201003, -1);
  EXPECT_TRUE(sees(Hazard::ClockJump, 1));
}

TEST_F(NidaqmxMonitors, VoltageThatWasNotWrittenIsABrokenClockInTheNextTick) {
  fake_fail("DAQmxWriteAnalogScalarF64", -200284, 1);
  see(1);
  EXPECT_TRUE(sees(Hazard::ClockJump, 1));
}

TEST_F(NidaqmxMonitors, StuckLaserIsFrozenOnceTheVoltageMoves) {
  board_.laser_stuck = true;
  driven_.hold(2'500'000, 1);
  EXPECT_TRUE(sees(Hazard::SensorFrozen, 25));
}

TEST_F(NidaqmxMonitors, OpenInterlockIsAMonitorThatDisagrees) {
  stage_.feed_interlock(false);
  EXPECT_TRUE(sees(Hazard::MonitorDisagrees, 25));
}

}  // namespace
}  // namespace biopsy::nidaqmx
