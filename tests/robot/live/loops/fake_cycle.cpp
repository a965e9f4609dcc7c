#include "tests/robot/live/loops/fake_cycle.hpp"

#include "tests/robot/live/loops/fake_bus.hpp"

namespace biopsy::fake_cycle {

Calls& calls() {
  static Calls one;
  return one;
}

}  // namespace biopsy::fake_cycle

namespace biopsy::robot {

using fake_cycle::calls;

std::int32_t writer_count(const WriterCounts& counts) {
  calls().writers = counts;
  return calls().writer_count;
}

void accept_plan(const SealedPlan& sealed, SupervisorMemory& memory) {
  calls().accepted.push_back(sealed);
  memory.plan.plan_tag = calls().plan_tag;
}

void confirm_plan(const PlanConfirmation& confirmation, std::int64_t now_us, SupervisorMemory&) {
  calls().confirmed.emplace_back(confirmation, now_us);
}

Supervision supervise(const SupervisorSources& in, SupervisorMemory& memory, FaultHooks*) {
  calls().supervised.push_back(in);
  calls().supervisor_config = memory.config_tag;
  calls().self_test = memory.self_test;
  calls().session = memory.state.session;
  calls().needs_second_person = memory.needs_second_person;
  memory.state.mode = calls().output.permit.mode;
  memory.arm_turned_us = calls().arm_turned_us;
  Supervision out;
  out.output = calls().output;
  out.panel_unread_ms = calls().panel_unread_ms;
  return out;
}

Decision decision_message(const Supervision& supervision, std::int64_t now_us, std::int64_t wall_ns) {
  Decision decision;
  decision.seq = supervision.output.permit.seq;
  decision.time_us = now_us;
  decision.at_ns = wall_ns;
  decision.epoch = fake_cycle::kEpochOfMessage;
  decision.panel_unread_ms = supervision.panel_unread_ms;
  return decision;
}

safety::SupervisorOutput supervisor_output(const Decision& decision, const Permit& permit) {
  safety::SupervisorOutput output;
  output.permit = permit;
  output.permit.mode = decision.mode;
  output.step = decision.step;
  output.worst = static_cast<safety::Hazard>(decision.worst);
  output.reason = static_cast<safety::Hazard>(decision.reason);
  return output;
}

void load_plan(const SealedPlan& sealed, ControllerMemory& memory) {
  calls().loaded.push_back(sealed);
  memory.plan_tag = calls().plan_tag;
  memory.plan.reset();
  if (calls().plan_tag != 0) memory.plan.emplace();
}

DriveRequest control(const ControllerInputs& in, ControllerMemory& memory) {
  calls().controlled.push_back(in);
  calls().controller_config = memory.config_tag;
  fake_bus::state().now_ns += calls().control_ns;
  DriveRequest request;
  request.seq = in.measurement.seq + 1'000;
  return request;
}

}  // namespace biopsy::robot

namespace biopsy::drivers {

Measurement GatedStage::measure() {
  const SensorReading reading = stage_.read();
  ++last_.seq;
  last_.depth_um = reading.depth_um;
  return last_;
}

void GatedStage::drive(const DriveRequest* request, const Permit* permit, std::int64_t now_us,
                       std::int32_t writers) {
  fake_cycle::Drive drive;
  drive.now_us = now_us;
  drive.writers = writers;
  if (request != nullptr) drive.request = *request;
  if (permit != nullptr) drive.permit = *permit;
  fake_cycle::calls().driven.push_back(drive);
  if (const auto& voltage = fake_cycle::calls().voltage) {
    stage_.write(*voltage);
    last_.hv_enabled = voltage->hv_enabled();
  }
  feeds_interlock_ = fake_cycle::calls().feeds_interlock;
}

}  // namespace biopsy::drivers
