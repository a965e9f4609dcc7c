#include "robot/cycle/operator_inputs.hpp"

namespace biopsy::robot {

OperatorInputs OperatorInputs::idle() {
  OperatorInputs inputs;
  inputs.estop_closed = true;
  inputs.stop = StopCategory::None;
  inputs.acquiring = false;
  inputs.patient_motion_um = 0;
  return inputs;
}

OperatorAct operator_act(const OperatorInputs& inputs) {
  OperatorAct act;
  act.token = inputs.press.token;
  act.held = inputs.press.held;
  act.stop = inputs.stop;
  act.finish = inputs.finish;
  act.acquiring = inputs.acquiring;
  act.hold_still = inputs.hold_still;
  act.arm = inputs.remote_arm;
  act.reset = inputs.remote_reset;
  act.patient_motion_um = inputs.patient_motion_um;
  return act;
}

DepthVerdictNote depth_verdict(const OperatorInputs& inputs, std::uint64_t plan_tag) {
  DepthVerdictNote verdict;
  verdict.plan_tag = plan_tag;
  verdict.step = inputs.accepted_step;
  verdict.accepted = inputs.depth_accepted;
  verdict.session = inputs.accepted_session;
  verdict.since_seq = inputs.accepted_since_seq;
  return verdict;
}

digital_io::PanelLevels panel_levels(const OperatorInputs& inputs) {
  return {.arm_key = inputs.arm,
          .reset_key = inputs.reset,
          .estop_a_closed = inputs.estop_closed,
          .estop_b_closed = inputs.estop_closed,
          .bench_key = inputs.bench_confirmed};
}

}  // namespace biopsy::robot
