#include "tests/verification/fault_injection/procedure.hpp"

#include <cmath>
#include <cstdlib>

#include "planner/plan/seal.hpp"
#include "safety/types/limits.hpp"
#include "tests/safety/situation.hpp"

namespace biopsy::fault_injection {
drivers::SensorReading BreakableStage::read() {
  drivers::SensorReading reading = sound_.read();
  const std::int32_t first_um = reading.depth_um, second_um = reading.depth_b_um;
  if (corruptors_.reading) corruptors_.reading(reading);
  // What is shown by the first laser is shown by both, unless the fault says what the second shows: the other
  // monitors must find it without the comparison.
  const bool common =
      reading.depth_um != first_um && reading.depth_b_um == second_um && !corruptors_.one_laser;
  if (common) reading.depth_b_um = reading.depth_um;
  return reading;
}

std::int32_t BreakableStage::write(const safety::GatedVoltage& voltage) {
  const std::int64_t now_us = sound_.now_us();
  if (!corruptors_.driver_stopped) {
    asked_ = voltage;
    if (voltage.feeds_interlock()) relay_ = safety::feed_from_driver(relay_, now_us);
  }
  const bool closed = safety::is_closed(relay_, now_us);
  const double asked_V = asked_.mV() * 1e-3;
  const double volts =
      corruptors_.amplifier ? corruptors_.amplifier(asked_V, asked_.hv_enabled(), closed) : asked_V * closed;
  sound_.push(corruptors_.push_N ? corruptors_.push_N(truth().motion) : 0.0);
  sound_.put_out(volts, asked_.brake_on() && closed);
  return corruptors_.driver_stopped ? asked_.mV() : voltage.mV();
}

void BreakableStage::pulse_from_supervisor() {
  relay_ = safety::feed_from_supervisor(relay_, sound_.now_us());
}

Procedure::Procedure(const Scenario& scenario)
    : scenario_(scenario),
      stage_(scenario, corruptors_),
      supervised_(scenario.plan, scenario.facts, stage_, {scenario.facts.plan_tag, scenario.facts.plan_tag}),
      operator_(scenario.plan, scenario.scan) {
  supervised_.wrap(*this);
  robot::load_plan(scenario.plan, controller_);
}

TickRecord Procedure::tick() {
  line_ = {};
  line_.tick = supervised_.ticks();
  robot::OperatorInputs world = operator_.act(last_, line_.tick);
  robot::Environment environment = robot::Environment::healthy();
  if (operator_.wants_verdict()) operator_.judge(DepthVerdict::Accept, "");
  if (corruptors_.world) corruptors_.world(world);
  inputs_ = world;
  if (corruptors_.environment) corruptors_.environment(environment);
  last_ = supervised_.run(world, environment,
                          [&](const Measurement& measured, const safety::SupervisorOutput& decided) {
                            DriveRequest request = robot::control({.measurement = measured,
                                                                   .permit = decided.permit,
                                                                   .step = decided.step,
                                                                   .finish = world.finish,
                                                                   .hold_still = world.hold_still},
                                                                  controller_);
                            if (corruptors_.request) corruptors_.request(request);
                            return request;
                          });
  operator_.observe(last_);
  if (last_.supervisor.interlock_pulse) stage_.pulse_from_supervisor();
  line_.mode = last_.supervisor.permit.mode;
  line_.hazards = last_.evidence.hazards();
  line_.event = last_.supervisor.event;
  line_.step = last_.supervisor.step;
  line_.flagged = last_.supervisor.image_disturbed;
  line_.enabled = stage_.enabled();
  line_.command_mV = last_.drive_mV;
  line_.output_kV = stage_.truth().u_i * 1e-3;
  line_.depth_mm = stage_.truth().motion.x * 1e3;
  return line_;
}

void Procedure::before_monitors(safety::SupervisorInputs& seen) {
  if (corruptors_.observation) corruptors_.observation(seen);
  const Measurement& m = seen.measurement;
  const bool switched = std::abs(m.command_mV - switched_from_mV_) > limits::kZeroVolt_mV;
  switched_from_mV_ = m.command_mV;
  line_.shown = !corruptors_.shows || corruptors_.shows({seen, stage_.truth().motion, switched});
  seen_ = seen;
  line_.seen_um = m.depth_um;
  line_.monitor_mV = m.monitor_mV;
  line_.current_nA = m.current_nA;
}

void Procedure::before_decision(safety::SupervisorInputs& inputs, safety::Evidence& evidence) {
  static_cast<safety::SupervisorInputs&>(decided_on_) = inputs;
  decided_on_.evidence = evidence;
  if (corruptors_.input) corruptors_.input(decided_on_);
  inputs = decided_on_;
  evidence = decided_on_.evidence;
}

void Procedure::before_gate(robot::GateInputs& inputs) {
  if (corruptors_.delivery) corruptors_.delivery(inputs);
  if (observer_) observer_(facts(), seen_, decided_on_, inputs);
}

}  // namespace biopsy::fault_injection
