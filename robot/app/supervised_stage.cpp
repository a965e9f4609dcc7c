#include "robot/app/supervised_stage.hpp"

#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "planner/seal.hpp"

namespace biopsy::app {
namespace {

constexpr std::uint32_t kSession = 1;     // a virtual clock starts its first session
constexpr std::int32_t kMeanTicks = 512;  // about one period of the square wave

// How far the needle is outside what the plan's tissue explains at this mean drive. um
std::int32_t tissue_residual(const safety::PlanFacts& facts, std::int32_t mean_drive_mV,
                             std::int32_t depth_um) {
  const safety::DepthRange range = safety::plausible_depth(facts, mean_drive_mV, mean_drive_mV);
  return std::max({range.low_um - depth_um, depth_um - range.high_um, 0});
}

// Sealed anew: a plan that was changed after its seal has another tag than the one that was permitted and
// confirmed.
std::uint64_t tag_of(Plan plan) {
  planner::seal(plan);
  return planner::plan_tag(plan);
}

}  // namespace

SupervisedStage::SupervisedStage(const Plan& plan, const safety::PlanFacts& facts, port::NeedleStage& stage,
                                 const std::array<std::uint64_t, 2>& confirmed)
    : facts_(facts),
      confirmed_(confirmed),
      plan_tag_(tag_of(plan)),
      stage_(stage),
      supervisor_(safety::started(kSession)) {}

safety::Observation SupervisedStage::observed(const Measurement& measurement, const World& world) const {
  safety::Observation seen;
  seen.now_us = (ticks_ + 1) * std::chrono::microseconds(kTick).count();
  seen.measurement = measurement;
  seen.request = request_;
  seen.permit = permit_;
  seen.writers = world.writers;
  seen.estop_a_closed = seen.estop_b_closed = world.estop_closed;
  seen.acquiring = world.acquiring;
  seen.log_backlog_ms = world.log_backlog_ms;
  seen.patient_motion_um = world.patient_motion_um;
  seen.tissue_residual_um = tissue_residual(facts_, mean_drive_mV_, measurement.depth_um);
  seen.plan_tag = plan_tag_;
  seen.config_tag = facts_.config_tag;
  seen.confirmed_tag = confirmed_;
  seen.bench_confirmed = world.bench_confirmed;
  return seen;
}

Tick SupervisedStage::tick(const World& world, const Controller& controller) {
  Tick tick;
  tick.measurement = stage_.measure();
  mean_drive_mV_ += (std::abs(tick.measurement.command_mV) - mean_drive_mV_) / kMeanTicks;

  const safety::Observation seen = observed(tick.measurement, world);
  tick.evidence = safety::assess(facts_, memory_, seen);
  safety::SupervisorInput input;
  input.now_us = seen.now_us;
  input.evidence = tick.evidence;
  input.self_test = safety::SelfTest::Passed;
  input.local_arm = world.arm;
  input.local_reset = world.reset;
  input.stop = world.stop;
  input.motion = world.press;
  input.request = request_;
  input.depth_accepted = world.depth_accepted;
  input.accepted_stage = world.accepted_stage;
  std::tie(supervisor_, tick.supervisor) = safety::step(facts_, supervisor_, input);
  permit_ = tick.supervisor.permit;

  request_ = tick.request = controller(tick.measurement, tick.supervisor);

  stage_.drive(&request_, &permit_, seen.now_us, world.writers);
  tick.drive_mV = stage_.command_mV();
  ++ticks_;
  return tick;
}

}  // namespace biopsy::app
