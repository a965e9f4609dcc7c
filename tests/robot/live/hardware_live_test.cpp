// The real processes on the laboratory's stage, whose board is not there: the vendor's library of the tests
// stands in its place, in the stage's process and in the supervisor's.
#include <gtest/gtest.h>

#include "tests/robot/live/laboratory.hpp"
#include "tests/robot/live/steady_host.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::live_tests {
namespace {

TEST(HardwareLive, ACommissionedStageGetsReadyAndNothingMovesBeforeAHandTurnsTheKey) {
  verifies("R-40");
  const Lab lab;
  lab.commission();
  on_a_steady_host([&]() -> std::string {
    const ScratchFolder run;
    const robot::PreparedCase prepared = robot::prepare(robot::read_case("gap"), run.path());
    robot::LiveSession session(lab.options, "nidaqmx", lab.hardware, prepared, run.path());
    session.wait_until_healthy();
    session.send_plan(std::get<Plan>(prepared.plan));
    robot::OperatorInputs asking = robot::OperatorInputs::idle();  // over the network: which arms nothing
    asking.remote_arm = true;
    bool ready = false;
    std::string hazard;
    Measurement seen;
    for (int n = 0; n < 3'000; ++n) {
      const std::optional<robot::CycleSample> cycle = session.robot().tick(asking);
      if (!cycle) continue;
      ready = ready || cycle->record.supervisor.permit.mode == Mode::Ready;
      hazard = robot::hazard_text(cycle->record.supervisor.worst, cycle->record.panel_unread_ms);
      seen = cycle->record.measurement;
      EXPECT_FALSE(cycle->record.supervisor.permit.hv_enable);
    }
    EXPECT_TRUE(seen.laser_valid);
    EXPECT_NEAR(seen.depth_um, 0, 100);
    EXPECT_EQ(seen.command_mV, 0);
    session.stop();
    return ready ? "" : "the robot never got ready: " + hazard;
  });
}

TEST(HardwareLive, WithoutItsCommissioningRecordTheStageDoesNotStart) {
  const Lab lab;
  EXPECT_NE(lab.refusal().find("commissioning.json"), std::string::npos) << lab.refusal();
}

TEST(HardwareLive, WithAnotherConfigurationThanTheCommissionedOneItDoesNotStart) {
  const Lab lab;
  lab.commission();
  std::ofstream(lab.hardware.config, std::ios::app) << "\n# one more line\n";
  EXPECT_NE(lab.refusal().find("configuration"), std::string::npos) << lab.refusal();
}

TEST(HardwareLive, WithoutTheRelaysContactTheStageDoesNotStart) {
  verifies("R-65");
  const Lab lab;
  std::string text = file_content(lab.hardware.config);
  const std::size_t from = text.find("[relay_contact]");
  text.erase(from, text.find("[supervisor_pulse]") - from);
  std::ofstream(lab.hardware.config) << text;
  lab.commission();
  EXPECT_NE(lab.refusal().find("relay is not read back"), std::string::npos) << lab.refusal();
}

TEST(HardwareLive, WithoutALineForItsPulseTheSupervisorDoesNotStart) {
  verifies("R-43");
  const Lab lab;
  std::string text = file_content(lab.hardware.config);
  text.erase(text.find("[supervisor_pulse]"));
  std::ofstream(lab.hardware.config) << text;
  EXPECT_NE(lab.refusal().find("half of the interlock"), std::string::npos) << lab.refusal();
}

}  // namespace
}  // namespace biopsy::live_tests
