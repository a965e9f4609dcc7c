#include "robot/cycle/simulated_robot.hpp"

namespace biopsy::robot {

CycleRecord SimulatedRobot::tick(const World& world) {
  return stage_.tick(world, [&](const Measurement& measured, const safety::SupervisorOutput& decided) {
    const control::RunnerStep wanted =
        control::run_stage(plan_, {}, controller_, measured, decided.permit, decided.stage, world.finish);
    controller_ = wanted.state;
    return wanted.request;
  });
}

}  // namespace biopsy::robot
