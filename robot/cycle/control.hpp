// Control: from a measurement and the permit to what the controller requests. The one place where the
// controller's inputs are put together, live and in lockstep.
#pragma once

#include <cstdint>
#include <optional>

#include "robot/control/step_runner.hpp"
#include "robot/msg/messages.hpp"

namespace biopsy::robot {

struct ControllerInputs {
  Measurement measurement;
  Permit permit;
  std::uint32_t step = 0;      // that the supervisor wants driven
  bool finish = false;         // the operator is done: withdraw
  bool hold_still = false;     // the operator wants an image: lock the needle
  std::uint32_t overruns = 0;  // control periods missed since start
};

struct ControllerMemory {
  std::uint64_t config_tag = 0;
  std::optional<Plan> plan{};
  std::uint64_t plan_tag = 0;  // of `plan`; 0: none
  control::RunnerState runner{};
};

// The plan that is run from now on; none where its seal does not hold or it has no step. Requests keep their
// numbers: gate and supervisor know them by these.
void load_plan(const SealedPlan& sealed, ControllerMemory& memory);
void load_plan(std::optional<Plan> plan, ControllerMemory& memory);

// Without a plan that has the step, a request for nothing: the controller is alive.
DriveRequest control(const ControllerInputs& in, ControllerMemory& memory);

}  // namespace biopsy::robot
