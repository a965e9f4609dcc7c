// The operator's side of a tick: each input to its own field of the message, level of the panel or verdict.
#include "robot/cycle/operator_inputs.hpp"

#include <gtest/gtest.h>

namespace biopsy::robot {
namespace {

TEST(OperatorInputs, AtRestAskForNothingAndAllIsWell) {
  const OperatorInputs idle = OperatorInputs::idle();
  EXPECT_TRUE(idle.estop_closed);
  EXPECT_EQ(idle.stop, StopCategory::None);
  EXPECT_FALSE(idle.acquiring || idle.hold_still || idle.arm || idle.reset || idle.finish);
  EXPECT_EQ(idle.patient_motion_um, 0);
  const OperatorInputs unknown;
  EXPECT_EQ(unknown.stop, StopCategory::C0Off);
  EXPECT_EQ(unknown.patient_motion_um, safety::kUnknown);
}

TEST(OperatorInputs, EachKeyIsItsOwnLevelOfThePanel) {
  using Levels = digital_io::PanelLevels;
  const auto with = [](bool OperatorInputs::*key) {
    OperatorInputs inputs;
    inputs.*key = true;
    return panel_levels(inputs);
  };
  EXPECT_EQ(with(&OperatorInputs::arm), (Levels{.arm_key = true}));
  EXPECT_EQ(with(&OperatorInputs::reset), (Levels{.reset_key = true}));
  EXPECT_EQ(with(&OperatorInputs::estop_closed), (Levels{.estop_a_closed = true, .estop_b_closed = true}));
  EXPECT_EQ(with(&OperatorInputs::bench_confirmed), (Levels{.bench_key = true}));
  for (const auto of_the_network :
       {&OperatorInputs::remote_arm, &OperatorInputs::remote_reset, &OperatorInputs::finish,
        &OperatorInputs::depth_accepted, &OperatorInputs::acquiring, &OperatorInputs::hold_still})
    EXPECT_EQ(with(of_the_network), Levels{}) << "nothing but a hand turns a key";
}

}  // namespace
}  // namespace biopsy::robot
