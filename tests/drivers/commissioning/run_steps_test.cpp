// A sound stage passes every step of commissioning; each fault is found by its step.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/robot/bench/commissioning_benches.hpp"

namespace biopsy::commissioning {
namespace {

TEST(Commissioning, SoundSimulatedStagePassesEveryStep) {
  const Record record = SimulatedCommissioning().run();
  EXPECT_TRUE(record.passed()) << text_of(record);
  EXPECT_EQ(record.steps.size(), all_steps().size());
}

TEST(Commissioning, SoundLaboratoryPassesEveryStep) {
  Laboratory laboratory;
  const Record record = laboratory.run();
  EXPECT_TRUE(record.passed()) << text_of(record);
  EXPECT_EQ(laboratory.board.output_V, 0.0);
}

TEST(Commissioning, SameStageSameFigures) {
  EXPECT_EQ(to_json(SimulatedCommissioning().run()), to_json(SimulatedCommissioning().run()));
}

TEST(Commissioning, NoStepGoesAboveHalfAKilovolt) {
  Laboratory laboratory;
  laboratory.run();
  EXPECT_LE(laboratory.board.highest_V, 0.5);
  EXPECT_GT(laboratory.board.highest_V, 0.49);
}

struct Fault {
  const char* name;
  void (*make)(Laboratory&);
  const char* found_by;
};

class CommissioningFault : public testing::TestWithParam<Fault> {};

TEST_P(CommissioningFault, IsFoundByItsStepWhichIsTheLast) {
  Laboratory laboratory;
  GetParam().make(laboratory);
  const Record record = laboratory.run();
  EXPECT_EQ(ended_by(record), GetParam().found_by) << text_of(record);
  EXPECT_FALSE(record.passed());
  EXPECT_EQ(laboratory.board.output_V, 0.0);
}

INSTANTIATE_TEST_SUITE_P(
    Of, CommissioningFault,
    testing::Values(Fault{"LaserWithoutTarget", [](Laboratory& l) { l.board.laser_zero_V = 20.0; },
                          "wiring at 0 V: laser readings that are valid"},
                    Fault{"NoisyLaser", [](Laboratory& l) { l.board.laser_noise_V = 0.04; },
                          "wiring at 0 V: scatter of the laser"},
                    Fault{"StuckConverter", [](Laboratory& l) { l.stage.read(), l.board.laser_stuck = true; },
                          "wiring at 0 V: fewest different laser codes in 20 ms"},
                    Fault{"MonitorOffset", [](Laboratory& l) { l.board.monitor_offset_V = 0.05; },
                          "wiring at 0 V: voltage monitor at 0 V"},
                    Fault{"NoisyMonitor", [](Laboratory& l) { l.board.monitor_noise_V = 0.05; },
                          "wiring at 0 V: scatter of the voltage monitor"},
                    Fault{"LaserZero", [](Laboratory& l) { l.board.laser_zero_V = 1.6; },
                          "laser zero and direction: depth at rest"},
                    Fault{"LaserScale", [](Laboratory& l) { l.board.laser_mm_per_V = 2.1; },
                          "laser zero and direction: laser minus block"},
                    Fault{"LaserDirection", [](Laboratory& l) { l.board.laser_mm_per_V = -2.0; },
                          "laser zero and direction: laser minus block"},
                    Fault{"BlockMistyped", [](Laboratory& l) { l.operator_.block_mm = 40.0; },
                          "laser zero and direction: gauge block"},
                    Fault{"MonitorScale", [](Laboratory& l) { l.board.monitor_gain = 0.95; },
                          "monitor gain: gain of monitor over command"},
                    Fault{"MonitorReversed", [](Laboratory& l) { l.board.monitor_gain = -1.0; },
                          "monitor gain: gain of monitor over command"},
                    Fault{"NoInterlock", [](Laboratory& l) { l.board.has_interlock = false; },
                          "interlock: time until it is gone"},
                    Fault{"NoSupervisorsHalf", [](Laboratory& l) { l.board.has_supervisors_half = false; },
                          "interlock, supervisor's half: time until it is gone"},
                    Fault{"SlowInterlock", [](Laboratory& l) { l.board.interlock_us = 40'000; },
                          "interlock: time until it is gone"},
                    Fault{"DeadContact", [](Laboratory& l) { l.board.dead_contacts = 0b1000; },
                          "emergency stop: from the first contact until the voltage is gone"},
                    Fault{"BoardGone", [](Laboratory&) { fake_fail("DAQmxReadAnalogF64", -201003, -1); },
                          "wiring at 0 V: laser readings that are valid"}),
    [](const auto& fault) { return fault.param.name; });

TEST(Commissioning, EmergencyStopOnOtherLinesIsJudgedByTheVoltageAlone) {
  nidaqmx::Config config = nidaqmx::laboratory();
  config.panel.reset();
  Laboratory laboratory(config);
  EXPECT_TRUE(laboratory.run().passed());
}

TEST(Commissioning, EmergencyStopThatIsNotPressedIsNotPassed) {
  Laboratory laboratory;
  laboratory.board.dead_contacts = 0b1100;
  EXPECT_EQ(laboratory.run().steps.back().name, "emergency stop");
}

TEST(Commissioning, StepThatTheOperatorDoesNotConfirmIsNotPassed) {
  for (const Act act : {Act::Prepare, Act::LayBlock, Act::RemoveBlock, Act::PressEstopUnderVoltage}) {
    SimulatedCommissioning commissioning;
    commissioning.operator_.refuses = {act};
    EXPECT_FALSE(commissioning.run().passed());
  }
}

TEST(Commissioning, StepsAreDescribedWithLimitsAndReasons) {
  const std::string text = describe_steps();
  for (const Step& step : all_steps()) {
    EXPECT_NE(text.find(step.name), std::string::npos);
    for (const Limit& limit : step.limits) {
      EXPECT_NE(text.find(limit.why), std::string::npos) << limit.what;
      EXPECT_LT(limit.low, limit.high);
    }
  }
}

TEST(Commissioning, HardwareIsDrivenAMillisecondATick) {
  robot::SimulatedBench bench(quiet_model(), 1);
  robot::StageConnections connections = bench.connections();
  connections.real_time = true;
  robot::SupervisedRig rig(bench, connections);
  const std::int64_t before_ns = realtime::monotonic_ns();
  for (int k = 0; k < 20; ++k) EXPECT_GE(rig.rest().late_us, 0);
  EXPECT_GE(realtime::monotonic_ns() - before_ns, 19'000'000) << "a machine may be slower, never faster";
}

TEST(Commissioning, TerminalTakesNoAnswerForNo) {
  std::istringstream in("what\nyes\nn\n");
  std::ostringstream out;
  robot::TerminalOperator operator_(in, out);
  EXPECT_TRUE(operator_.confirm(Act::Prepare, "Connect everything."));
  EXPECT_FALSE(operator_.confirm(Act::Prepare, "And now?"));
  EXPECT_FALSE(operator_.confirm(Act::Prepare, "Is anybody there?")) << "the input has ended";
  EXPECT_NE(out.str().find("Connect everything."), std::string::npos);
}

TEST(Commissioning, TerminalTakesOnlyNumbersForNumbers) {
  std::istringstream in("four\n4 mm\nnan\n1e999\n4.00\n");
  std::ostringstream out;
  robot::TerminalOperator operator_(in, out);
  EXPECT_EQ(operator_.enter_value("Height of the block, mm"), 4.0);
  EXPECT_EQ(operator_.enter_value("Height of the block, mm"), std::nullopt);
}

}  // namespace
}  // namespace biopsy::commissioning
