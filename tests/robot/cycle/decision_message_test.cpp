// What the supervisor decided, as a message of the bus and back. Made by hand, each field with a value of its
// own.
#include <gtest/gtest.h>

#include "robot/cycle/supervise.hpp"

namespace biopsy::robot {
namespace {

// Numbers all different, each flag alone: a field that is read from its neighbour shows.
TEST(DecisionMessage, CarriesEachFieldOfTheSupervisorsOutputThereAndBack) {
  for (int flag = 0; flag < 4; ++flag) {
    safety::SupervisorOutput output;
    output.permit.seq = 3, output.permit.session = 4, output.permit.epoch = 5, output.permit.challenge = 9;
    output.permit.mode = Mode::Hold, output.permit.stop = StopCategory::C2Hold;
    output.event = safety::Event::StepReached;
    output.worst = safety::Hazard::PatientMotion, output.reason = safety::Hazard::StepDepth;
    output.refusal = safety::Refusal::PlanDone;
    output.step = 6;
    output.step_done = flag == 0, output.image_allowed = flag == 1, output.image_disturbed = flag == 2;
    output.interlock_pulse = flag != 2;
    const Decision expected{.seq = 3,
                            .time_us = 7,
                            .at_ns = 8,
                            .session = 4,
                            .epoch = 5,
                            .mode = Mode::Hold,
                            .stop = StopCategory::C2Hold,
                            .event = static_cast<std::uint8_t>(safety::Event::StepReached),
                            .worst = static_cast<std::uint8_t>(safety::Hazard::PatientMotion),
                            .reason = static_cast<std::uint8_t>(safety::Hazard::StepDepth),
                            .refusal = static_cast<std::uint8_t>(safety::Refusal::PlanDone),
                            .step = 6,
                            .step_done = flag == 0,
                            .image_allowed = flag == 1,
                            .image_disturbed = flag == 2,
                            .panel_unread_ms = 9,
                            .estop = flag == 3};
    safety::Evidence evidence;
    evidence.clear = flag == 3 ? 0 : safety::bit(safety::Hazard::EStop);  // a worse hazard is named
    const Decision message =
        decision_message({.evidence = evidence, .output = output, .panel_unread_ms = 9}, 7, 8);
    EXPECT_EQ(message, expected);
    Permit permit;  // of an earlier tick, but for what the message says
    permit.v_max_mV = 1'234, permit.challenge = 10;
    const safety::SupervisorOutput back = supervisor_output(message, permit);
    permit.seq = 3, permit.session = 4, permit.epoch = 5;
    permit.mode = Mode::Hold, permit.stop = StopCategory::C2Hold;
    EXPECT_EQ(back.permit, permit);
    EXPECT_EQ(decision_message({.evidence = evidence, .output = back, .panel_unread_ms = 9}, 7, 8), expected);
  }
}

}  // namespace
}  // namespace biopsy::robot
