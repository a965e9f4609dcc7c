#include "tests/verification/fault_injection/procedure.hpp"

#include <bit>
#include <cmath>
#include <cstdlib>

#include "planner/plan/seal.hpp"
#include "safety/types/limits.hpp"

namespace biopsy::proof {
namespace {

// The gate alone makes voltages; a broken amplifier does not ask it. The layout is that of GatedVoltage.
safety::GatedVoltage forged(double volts) {
  struct Twin {
    std::int32_t mV;
    bool enabled;
  };
  return std::bit_cast<safety::GatedVoltage>(Twin{static_cast<std::int32_t>(std::lround(volts * 1e3)), true});
}

}  // namespace

drivers::SensorReading BreakableStage::read() {
  drivers::SensorReading reading = sound_.read();
  if (spoilers_.reading) spoilers_.reading(reading);
  return reading;
}

void BreakableStage::write(const safety::GatedVoltage& voltage) {
  const std::int64_t now_us = sound_.now_us();
  if (!spoilers_.driver_stopped) {
    asked_ = voltage;
    relay_ = safety::feed_from_driver(relay_, now_us);
  }
  const bool closed = safety::is_closed(relay_, now_us);
  const double asked_V = asked_.mV() * 1e-3;
  const double volts =
      spoilers_.amplifier ? spoilers_.amplifier(asked_V, asked_.hv_enabled(), closed) : asked_V * closed;
  sound_.push(spoilers_.push_N ? spoilers_.push_N(truth().motion) : 0.0);
  sound_.write(forged(volts));
}

void BreakableStage::pulse_from_supervisor() {
  relay_ = safety::feed_from_supervisor(relay_, sound_.now_us());
}

Procedure::Procedure(const Scene& scene)
    : scene_(scene),
      facts_(scene.facts),
      stage_(scene, spoilers_),
      supervised_(scene.plan, facts_, stage_, {scene.facts.plan_tag, scene.facts.plan_tag}),
      person_(scene.plan) {
  supervised_.connect(*this);
}

Line Procedure::tick() {
  line_ = {};
  line_.tick = supervised_.ticks();
  robot::World world = person_.act(last_, line_.tick);
  if (person_.wants_verdict()) person_.judge(true, "");
  if (spoilers_.world) spoilers_.world(world);
  last_ = supervised_.tick(world, [&](const Measurement& measured, const safety::SupervisorOutput& decided) {
    const control::RunnerStep wanted = control::run_stage(scene_.plan, {}, controller_, measured,
                                                          decided.permit, decided.stage, world.finish);
    controller_ = wanted.state;
    DriveRequest request = wanted.request;
    if (spoilers_.request) spoilers_.request(request);
    return request;
  });
  if (last_.supervisor.interlock_pulse) stage_.pulse_from_supervisor();
  line_.mode = last_.supervisor.permit.mode;
  line_.hazards = last_.evidence.hazards();
  line_.event = last_.supervisor.event;
  line_.stage = last_.supervisor.stage;
  line_.flagged = last_.supervisor.image_disturbed;
  line_.enabled = stage_.enabled();
  line_.command_mV = last_.drive_mV;
  line_.output_kV = stage_.truth().u_i * 1e-3;
  line_.depth_mm = stage_.truth().motion.x * 1e3;
  return line_;
}

void Procedure::carry(safety::Observation& seen) {
  if (spoilers_.observation) spoilers_.observation(seen);
  const Measurement& m = seen.measurement;
  const bool switched = std::abs(m.command_mV - switched_from_mV_) > limits::kZeroVolt_mV;
  switched_from_mV_ = m.command_mV;
  line_.shown = !spoilers_.shows || spoilers_.shows({seen, stage_.truth().motion, switched});
  seen_ = seen;
  line_.seen_um = m.depth_um;
  line_.monitor_mV = m.monitor_mV;
  line_.current_nA = m.current_nA;
}

void Procedure::carry(safety::SupervisorInput& input) {
  if (spoilers_.input) spoilers_.input(input);
  asked_ = input;
}

void Procedure::carry(robot::Delivery& delivery) {
  if (spoilers_.delivery) spoilers_.delivery(delivery);
  if (tap_) tap_(facts_, seen_, asked_, delivery);
}

}  // namespace biopsy::proof
