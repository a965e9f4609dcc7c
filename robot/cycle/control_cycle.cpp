#include "robot/cycle/control_cycle.hpp"

#include <tuple>

#include "planner/plan/seal.hpp"

namespace biopsy::robot {
namespace {

constexpr std::uint32_t kSession = 1;  // a virtual clock starts its first session

// Sealed anew: a plan that was changed after its seal has another tag than the one that was permitted and
// confirmed.
std::uint64_t tag_of(Plan plan) {
  planner::seal(plan);
  return planner::plan_tag(plan);
}

}  // namespace

ControlCycle::ControlCycle(const Plan& plan, const safety::PlanFacts& facts, drivers::NeedleStage& stage,
                           const std::array<std::uint64_t, 2>& confirmed)
    : facts_(facts),
      confirmed_(confirmed),
      plan_tag_(tag_of(plan)),
      stage_(stage),
      supervisor_(safety::started(kSession)) {}

safety::Observation ControlCycle::observed(const Measurement& measurement, const World& world) {
  safety::Observation seen;
  seen.now_us = now_us();
  seen.measurement = measurement;
  seen.request = request_;
  seen.permit = permit_;
  seen.writers = world.writers;
  seen.estop_a_closed = seen.estop_b_closed = world.estop_closed;
  seen.acquiring = world.acquiring;
  seen.log_backlog_ms = world.log_backlog_ms;
  seen.patient_motion_um = world.patient_motion_um;
  seen.tissue_residual_um = safety::tissue_residual_um(facts_, tissue_, measurement);
  seen.plan_tag = plan_tag_;
  seen.config_tag = facts_.config_tag;
  seen.confirmed_tag = confirmed_;
  seen.bench_confirmed = world.bench_confirmed;
  return seen;
}

CycleRecord ControlCycle::tick(const World& world, const Controller& controller) {
  CycleRecord tick;
  tick.measurement = stage_.measure();
  safety::Observation seen = observed(tick.measurement, world);
  if (faults_ != nullptr) faults_->carry(seen);
  safety::SupervisorInput input;
  input.now_us = seen.now_us;
  input.evidence = safety::assess(facts_, memory_, seen);
  input.self_test = safety::SelfTest::Passed;
  input.local_arm = world.arm;
  input.local_reset = world.reset;
  input.remote_arm = world.remote_arm;
  input.remote_reset = world.remote_reset;
  input.stop = world.stop;
  input.motion = world.press;
  input.request = seen.request;
  input.depth_accepted = world.depth_accepted;
  input.accepted_stage = world.accepted_stage;
  if (faults_ != nullptr) faults_->carry(input);
  tick.evidence = input.evidence;
  std::tie(supervisor_, tick.supervisor) = safety::step(facts_, supervisor_, input);
  permit_ = tick.supervisor.permit;

  request_ = tick.request = controller(tick.measurement, tick.supervisor);

  Delivery delivery{&request_, &permit_, now_us(), world.writers};
  if (faults_ != nullptr) faults_->carry(delivery);
  stage_.drive(delivery.request, delivery.permit, delivery.now_us, delivery.writers);
  tick.drive_mV = stage_.command_mV();
  ++ticks_;
  return tick;
}

}  // namespace biopsy::robot
