#include "robot/cycle/control.hpp"

#include "planner/plan/open_plan.hpp"
#include "planner/plan/seal.hpp"

namespace biopsy::robot {

void load_plan(const SealedPlan& sealed, ControllerMemory& memory) {
  load_plan(planner::open_plan(sealed.bytes, sealed.seal), memory);
}

void load_plan(std::optional<Plan> plan, ControllerMemory& memory) {
  if (plan && plan->steps.empty()) plan.reset();
  const std::uint32_t seq = memory.runner.seq;
  memory.runner = {};
  memory.runner.seq = seq;
  memory.plan_tag = plan ? planner::plan_tag(*plan) : 0;
  memory.plan = std::move(plan);
}

DriveRequest control(const ControllerInputs& in, ControllerMemory& memory) {
  DriveRequest request;
  if (memory.plan && in.step < memory.plan->steps.size()) {
    const control::RunnerStep step =
        control::run_steps(*memory.plan, memory.runner, in.measurement, in.permit,
                           {.step = in.step, .hold_still = in.hold_still, .finish = in.finish});
    memory.runner = step.state;
    request = step.request;
  } else {
    request.seq = ++memory.runner.seq;
    request.measured_seq = in.measurement.seq;
  }
  request.overruns = in.overruns;
  request.plan_tag = memory.plan_tag;
  if (memory.plan) request.plan_seal = memory.plan->seal;
  request.config_tag = memory.config_tag;
  return request;
}

}  // namespace biopsy::robot
