// What one monitor tells another, and what the evidence takes from each. A stage that behaves
// (tests/safety/rig) but for what a test spoils.
#include "safety/monitors/evidence.hpp"

#include <gtest/gtest.h>

#include "tests/safety/rig.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

// The relay stays open, as if the driver's timer had opened it: but who knows whether the driver heard?
TEST(Evidence, AnInterlockIsProvenOnlyByAStageThatAnswers) {
  verifies("R-65");
  for (const bool answers : {true, false}) {
    Rig rig;
    rig.on_input = [](Situation& input) { input.self_test = SelfTest::Pending; };  // stays in Boot
    if (!answers) rig.on_measurement = [](Measurement& m) { m.answer ^= 1; };
    bool proven = false;
    for (int tick = 0; tick < 200; ++tick) rig.tick(), proven |= rig.evidence.interlock_opens;
    ASSERT_EQ(rig.state.mode, Mode::Boot);
    EXPECT_EQ(proven, answers);
  }
}

TEST(Evidence, AnInterlockIsNotProvenByAStageThatFellSilent) {
  verifies("R-65");
  Rig rig;
  rig.on_input = [](Situation& input) { input.self_test = SelfTest::Pending; };
  rig.run(20);
  ASSERT_FALSE(rig.evidence.interlock_opens);
  rig.on_measurement = [](Measurement& m) { m.seq = 20; };  // the last one again and again
  bool proven = false;
  for (int tick = 0; tick < 200; ++tick) rig.tick(), proven |= rig.evidence.interlock_opens;
  EXPECT_FALSE(proven);
}

TEST(Evidence, TellsInWhichTickTheKeyReleasedTheEmergencyStop) {
  verifies("R-03");
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  bool down = true;
  rig.on_observation = [&](SupervisorInputs& seen) { seen.estop_a_closed = seen.estop_b_closed = !down; };
  rig.tick();
  EXPECT_NE(rig.evidence.hazards() & bit(Hazard::EStop), 0U);
  down = false;
  rig.tick();
  EXPECT_FALSE(rig.evidence.estop_reset);
  rig.reset = true;
  rig.tick();
  EXPECT_TRUE(rig.evidence.estop_reset);
  EXPECT_EQ(rig.evidence.hazards(), 0U);
  rig.tick();
  EXPECT_FALSE(rig.evidence.estop_reset) << "once";
}

TEST(Evidence, TellsHowManyMillisecondsATickTook) {
  verifies("R-05");
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.tick();
  EXPECT_EQ(rig.evidence.elapsed_ms, 1);
  for (const int late_ms : {1, 3, 0}) {
    rig.now_us += 1'000 * late_ms;
    rig.tick();
    EXPECT_EQ(rig.evidence.elapsed_ms, 1 + late_ms);
  }
}

}  // namespace
}  // namespace biopsy::safety
