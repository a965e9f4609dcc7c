#include "robot/cycle/run_cycle.hpp"

#include "planner/plan/seal.hpp"

namespace biopsy::robot {
namespace {

constexpr std::uint32_t kSession = 1;  // a virtual clock starts its first session

// Sealed anew: a plan that was changed after its seal has another tag than the one that was permitted and
// confirmed.
Plan sealed(Plan plan) {
  planner::seal(plan);
  return plan;
}

}  // namespace

ControlCycle::ControlCycle(const Plan& plan, const safety::PlanFacts& facts, drivers::NeedleStage& stage,
                           const std::array<std::uint64_t, 2>& confirmed)
    : stage_(stage, facts.config_tag) {
  supervisor_.plan = facts;
  supervisor_.config_tag = facts.config_tag;
  supervisor_.self_test = safety::SelfTest::Passed;
  const Plan as_run = sealed(plan);
  supervisor_.sealed_tag = planner::plan_tag(as_run);
  supervisor_.seal = as_run.seal;
  supervisor_.confirmed_tag = confirmed;
  supervisor_.state = safety::started(kSession);
  assume_tested_panel(supervisor_);
  request_.plan_seal = supervisor_.seal;
  request_.config_tag = facts.config_tag;
}

// Messages arrive in the tick in which they were sent.
SupervisorSources ControlCycle::sources(const Measurement& measurement, const OperatorInputs& operator_inputs,
                                        const Environment& environment) const {
  SupervisorSources in;
  in.now_us = now_us();
  in.measurement = measurement;
  in.request = request_;
  in.files_tag = supervisor_.config_tag;
  in.writers = environment.writers;
  in.panel = {panel_levels(operator_inputs), true};
  in.panel.levels.relay_closed = safety::is_closed(relay_, in.now_us);
  in.act = {operator_act(operator_inputs), in.now_us};
  in.log = {{.backlog_ms = environment.log_backlog_ms}, in.now_us};
  in.verdict = depth_verdict(operator_inputs, supervisor_.plan.plan_tag);
  in.files_read_us = in.now_us;
  return in;
}

CycleRecord ControlCycle::run(const OperatorInputs& operator_inputs, const Environment& environment,
                              const Controller& controller) {
  CycleRecord record;
  record.measurement = stage_.measure();
  const Supervision supervision =
      supervise(sources(record.measurement, operator_inputs, environment), supervisor_, faults_);
  record.evidence = supervision.evidence;
  record.supervisor = supervision.output;
  record.panel_unread_ms = supervision.panel_unread_ms;
  request_ = controller(record.measurement, record.supervisor);
  request_.plan_tag = supervisor_.sealed_tag, request_.plan_seal = supervisor_.seal;
  request_.config_tag = supervisor_.config_tag;
  record.request = request_;
  actuate({request_, record.supervisor.permit, now_us(), environment.writers}, stage_, faults_);
  if (record.supervisor.interlock_pulse) relay_ = safety::feed_from_supervisor(relay_, now_us());
  if (stage_.feeds_interlock()) relay_ = safety::feed_from_driver(relay_, now_us());
  record.drive_mV = stage_.command_mV();
  ++ticks_;
  return record;
}

}  // namespace biopsy::robot
