#include "robot/cycle/supervise.hpp"

#include <algorithm>
#include <tuple>

#include "planner/plan/open_plan.hpp"
#include "planner/plan/seal.hpp"
#include "robot/cycle/plan_facts.hpp"

namespace biopsy::robot {
namespace {

constexpr std::int64_t kActMax_us = 500'000;  // an older operator act counts as unknown
// Ten are sent in a second.
constexpr std::int64_t kPatientSensorMax_us = 300'000;
// Time to walk to the device and turn the key; too short to change the patient.
constexpr std::int64_t kSecondPerson_us = 180'000'000;

bool is_known(const SupervisorSources& in) {
  return in.act.at_us != 0 && in.now_us - in.act.at_us <= kActMax_us;
}

std::int32_t log_backlog_ms(const SupervisorSources& in) {
  if (in.log.at_us == 0) return safety::kUnknown;
  const std::int64_t age_ms = (in.now_us - in.log.at_us) / 1000;
  return static_cast<std::int32_t>(
      std::min<std::int64_t>(in.log.message.backlog_ms + age_ms, safety::kUnknown));
}

// A motion that began with it goes on: it ends with the motion, in supervise().
bool is_confirmed_apart(const SupervisorMemory& memory, std::int64_t now_us) {
  const SupervisorMemory::SecondPerson& given = memory.second_person;
  return given.seal == memory.seal &&
         (safety::hv_permitted(memory.state.mode) || now_us - given.at_us <= kSecondPerson_us);
}

bool console_confirms(const SupervisorMemory& memory) {
  const std::uint64_t tag = memory.plan.plan_tag;
  return memory.confirmed_tag == std::array{tag, tag};
}

// The plan that the controller runs and the one that was sent last must both be the sealed one, by their
// whole seals: plans come to each process by themselves, in an order of their own. Each process states its
// plan and configuration in the messages that no other process may write. Files that changed since the start
// keep a robot from being armed; one that moves goes on with what it read.
void add_tags(const SupervisorSources& in, const SupervisorMemory& memory, safety::SupervisorInputs& inputs) {
  const bool same_plan = in.request.plan_seal == memory.seal;
  const bool same_config =
      in.measurement.config_tag == memory.config_tag && in.request.config_tag == memory.config_tag;
  inputs.plan_tag = same_plan ? memory.sealed_tag : 0;
  const bool same_files = in.files_tag == memory.config_tag || safety::hv_permitted(memory.state.mode);
  inputs.config_tag = same_config && same_files ? memory.config_tag : 0;
  inputs.confirmed_tag = memory.confirmed_tag;
  if (memory.needs_second_person && !is_confirmed_apart(memory, in.now_us)) inputs.confirmed_tag[1] = 0;
}

// The arm key waits for files that were read after it was turned: what was edited a moment before is not
// armed.
bool is_armed_by_key(const SupervisorSources& in, SupervisorMemory& memory, bool turned) {
  if (!turned) memory.arm_turned_us = 0;
  if (turned && memory.arm_turned_us == 0) memory.arm_turned_us = in.now_us;
  return turned && in.files_read_us >= memory.arm_turned_us;
}

void add_panel(const digital_io::PanelReading& panel, safety::PanelFilter& filter,
               safety::SupervisorInputs& inputs) {
  const digital_io::PanelLevels& levels = panel.levels;
  inputs.panel_read = safety::is_closed(filter.read, panel.read);
  inputs.relay_closed = levels.relay_closed;
  inputs.estop_a_closed = safety::is_closed(filter.estop_a, levels.estop_a_closed);
  inputs.estop_b_closed = safety::is_closed(filter.estop_b, levels.estop_b_closed);
  inputs.local_arm = safety::is_turned(filter.arm, levels.arm_key, panel.read);
  inputs.local_reset = safety::is_turned(filter.reset, levels.reset_key, panel.read);
  inputs.bench_confirmed = safety::is_closed(filter.bench, levels.bench_key);
}

// By a sensor of the navigation program. One that was there is needed until the supervisor is started anew:
// whoever relied on it must learn that it is gone.
std::int32_t measured_motion_um(const SupervisorSources& in, SupervisorMemory& memory) {
  const NavigationRequest& navigation = in.navigation.message;
  memory.patient_measured = memory.patient_measured || navigation.measures_patient;
  if (!memory.patient_measured) return 0;
  const bool fresh = in.now_us - in.navigation.at_us <= kPatientSensorMax_us;
  return fresh && navigation.measures_patient ? navigation.patient_motion_um : safety::kUnknown;
}

// The larger of what the images and a sensor show; a number below zero means nothing.
std::int32_t larger_motion_um(std::int32_t a, std::int32_t b) {
  return a < 0 || b < 0 ? safety::kUnknown : std::max(a, b);
}

// Without an operator nothing may rise; the needle holds (C2). A press and a remote request count once, when
// they arrive: nothing that is remembered keeps a button pressed. A verdict that names a permit which was not
// yet issued when it came is of no image, also once there is such a permit.
void add_operator(const SupervisorSources& in, SupervisorMemory& memory, safety::SupervisorInputs& inputs) {
  const OperatorAct& act = in.act.message;
  inputs.stop = StopCategory::C2Hold;
  if (is_known(in)) {
    inputs.stop = act.stop;
    inputs.acquiring = act.acquiring;
    inputs.patient_motion_um = act.patient_motion_um;
  }
  inputs.patient_motion_um = larger_motion_um(inputs.patient_motion_um, measured_motion_um(in, memory));
  if (in.act.at_us != memory.act_us) {
    inputs.motion = {act.token, act.held};
    inputs.remote_arm = act.arm;
    inputs.remote_reset = act.reset;
    memory.act_us = in.act.at_us;
  }
  if (in.verdict.session != memory.verdict_session || in.verdict.since_seq != memory.verdict_since_seq) {
    memory.verdict_session = in.verdict.session, memory.verdict_since_seq = in.verdict.since_seq;
    memory.verdict_in_order = in.verdict.since_seq <= memory.permit.seq;
  }
  const std::uint64_t plan_tag = memory.plan.plan_tag;
  const bool of_this_plan = in.verdict.plan_tag == plan_tag && plan_tag != 0;
  inputs.depth_accepted = in.verdict.accepted && of_this_plan && memory.verdict_in_order;
  inputs.accepted_step = in.verdict.step;
  inputs.accepted_session = in.verdict.session;
  inputs.accepted_since_seq = in.verdict.since_seq;
}

safety::SupervisorInputs supervisor_inputs(const SupervisorSources& in, SupervisorMemory& memory) {
  safety::SupervisorInputs inputs;
  inputs.now_us = in.now_us;
  inputs.self_test = memory.self_test;
  inputs.measurement = in.measurement;
  inputs.request = in.request;
  inputs.permit = memory.permit;
  inputs.writers = in.writers;
  inputs.log_backlog_ms = log_backlog_ms(in);
  inputs.tissue_residual_um = safety::tissue_residual_um(memory.plan, memory.tissue, in.measurement);
  add_tags(in, memory, inputs);
  add_panel(in.panel, memory.panel, inputs);
  inputs.local_arm = is_armed_by_key(in, memory, inputs.local_arm);
  add_operator(in, memory, inputs);
  return inputs;
}

}  // namespace

std::int32_t writer_count(const WriterCounts& counts) {
  for (const std::int32_t count : {counts.measurements, counts.requests, counts.acts})
    if (count != 1) return count;
  if (counts.measurements_alive != 1 || counts.requests_alive != 1) return 0;
  return std::max({counts.plans, counts.verdicts, counts.log, 1});
}

void assume_tested_panel(SupervisorMemory& memory) {
  memory.evidence.panel.test = safety::PanelMonitor::Test::Passed;
  memory.panel.arm.turned = memory.panel.reset.turned = false;
  for (safety::ContactFilter* contact : {&memory.panel.read, &memory.panel.estop_a, &memory.panel.estop_b})
    contact->closed_ticks = safety::kContact_ticks;
}

void accept_plan(const SealedPlan& sealed, SupervisorMemory& memory) {
  const std::optional<Plan> plan = planner::open_plan(sealed.bytes, sealed.seal);
  memory.sealed_tag = plan ? planner::plan_tag(*plan) : 0;
  if (safety::hv_permitted(memory.state.mode)) {
    if (sealed.seal != memory.seal) memory.sealed_tag = 0;  // another plan, whatever its tag
    return;
  }
  const bool fits =
      plan && plan->steps.size() <= safety::kMaxSteps && plan->limits.plausible.size() <= safety::kMaxBands;
  memory.plan = fits ? plan_facts(*plan, memory.config_tag) : safety::PlanFacts{};
  memory.seal = fits ? plan->seal : Sha256{};
  memory.confirmed_tag = sealed.confirmed_tag;
  if (!console_confirms(memory) || memory.second_person.seal != memory.seal) memory.second_person = {};
}

void confirm_plan(const PlanConfirmation& confirmation, std::int64_t now_us, SupervisorMemory& memory) {
  if (safety::hv_permitted(memory.state.mode) || !console_confirms(memory)) return;
  if (confirmation.seal == memory.seal) memory.second_person = {confirmation.seal, now_us};
}

Supervision supervise(const SupervisorSources& in, SupervisorMemory& memory, FaultHooks* faults) {
  safety::SupervisorInputs inputs = supervisor_inputs(in, memory);
  if (faults != nullptr) faults->before_monitors(inputs);
  Supervision out;
  out.evidence = safety::assess(memory.plan, memory.evidence, inputs);
  if (faults != nullptr) faults->before_decision(inputs, out.evidence);
  const bool moved = safety::hv_permitted(memory.state.mode);
  std::tie(memory.state, out.output) = safety::step(memory.plan, memory.state, inputs, out.evidence);
  memory.permit = out.output.permit;
  if (moved && !safety::hv_permitted(memory.state.mode)) memory.second_person = {};  // once
  const bool confirmed = (out.evidence.clear & safety::bit(safety::Hazard::PlanUnconfirmed)) != 0;
  out.confirmed_tag = confirmed ? memory.plan.plan_tag : 0;
  const bool stopped = (out.evidence.clear & safety::bit(safety::Hazard::EStop)) == 0;
  out.panel_unread_ms = memory.stop_cause.update(in.panel, stopped);
  return out;
}

std::string cause_of(const safety::SupervisorOutput& output, std::int32_t panel_unread_ms) {
  if (output.reason != safety::Hazard::None) return hazard_text(output.reason, panel_unread_ms);
  // Without a hazard it is a person's, or a navigation program's.
  return std::string(output.event == safety::Event::Fault ? "an immediate stop was asked for"
                                                          : safety::name_of(output.event));
}

Decision decision_message(const Supervision& supervision, std::int64_t now_us, std::int64_t wall_ns) {
  const safety::SupervisorOutput& output = supervision.output;
  Decision decision;
  decision.seq = output.permit.seq;
  decision.time_us = now_us;
  decision.at_ns = wall_ns;
  decision.session = output.permit.session;
  decision.epoch = output.permit.epoch;
  decision.mode = output.permit.mode;
  decision.stop = output.permit.stop;
  decision.event = static_cast<std::uint8_t>(output.event);
  decision.worst = static_cast<std::uint8_t>(output.worst);
  decision.reason = static_cast<std::uint8_t>(output.reason);
  decision.refusal = static_cast<std::uint8_t>(output.refusal);
  decision.step = output.step;
  decision.step_done = output.step_done;
  decision.confirmed_tag = supervision.confirmed_tag;
  decision.image_allowed = output.image_allowed;
  decision.image_disturbed = output.image_disturbed;
  decision.panel_unread_ms = supervision.panel_unread_ms;
  decision.estop = (supervision.evidence.clear & safety::bit(safety::Hazard::EStop)) == 0;
  return decision;
}

safety::SupervisorOutput supervisor_output(const Decision& decision, const Permit& permit) {
  safety::SupervisorOutput output;
  output.permit = permit;
  output.permit.session = decision.session;
  output.permit.epoch = decision.epoch;
  output.permit.seq = decision.seq;
  output.permit.mode = decision.mode;
  output.permit.stop = decision.stop;
  output.event = static_cast<safety::Event>(decision.event);
  output.worst = static_cast<safety::Hazard>(decision.worst);
  output.reason = static_cast<safety::Hazard>(decision.reason);
  output.refusal = static_cast<safety::Refusal>(decision.refusal);
  output.step = decision.step;
  output.step_done = decision.step_done;
  output.image_allowed = decision.image_allowed;
  output.image_disturbed = decision.image_disturbed;
  return output;
}

}  // namespace biopsy::robot
