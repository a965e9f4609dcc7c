// What an operator and the surroundings of the robot contribute to a tick, and the messages and levels that
// carry it. The simulated robot and the operator's side of the live robot use the same functions.
// Default-constructed: unknown is bad.
#pragma once

#include <cstdint>

#include "drivers/digital_io/io_layout.hpp"
#include "robot/msg/messages.hpp"
#include "safety/types/supervisor_inputs.hpp"

namespace biopsy::robot {

struct OperatorInputs {
  // On the device: levels
  bool arm = false, reset = false;  // keys
  bool estop_closed = false;        // both channels; closed = not pressed
  bool bench_confirmed = false;     // no patient, no needle
  // Over the network
  bool remote_arm = false, remote_reset = false;  // always refused
  safety::MotionPress press;                      // hold-to-run
  StopCategory stop = StopCategory::C0Off;
  bool finish = false;          // withdraw: the procedure is over
  bool depth_accepted = false;  // the depth check of `accepted_step` said Accept
  std::uint32_t accepted_step = 0;
  std::uint32_t accepted_session = 0,
                accepted_since_seq = 0;  // of the permit when its image began to be taken
  bool acquiring = true;                 // the scanner takes an image
  bool hold_still = false;               // an image is wanted: lock the needle and take the voltage away
  std::int32_t patient_motion_um = safety::kUnknown;

  // Nobody asks for anything and all is well: E-stop released, no image, patient at rest.
  static OperatorInputs idle();
};

// What is neither the operator's nor the robot's doing.
struct Environment {
  std::int32_t log_backlog_ms = safety::kUnknown;
  std::int32_t writers = 0;  // of the single-writer topics

  static Environment healthy() { return {.log_backlog_ms = 0, .writers = 1}; }
};

OperatorAct operator_act(const OperatorInputs& inputs);                                // seq is the sender's
DepthVerdictNote depth_verdict(const OperatorInputs& inputs, std::uint64_t plan_tag);  // seq is the sender's
digital_io::PanelLevels panel_levels(const OperatorInputs& inputs);

}  // namespace biopsy::robot
