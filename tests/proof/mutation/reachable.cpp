// The relation of supervisor and gate over all that is reachable, by the exploration's own walk.
#include "relation_hash.hpp"
#include "tests/proof/explore/explorer.hpp"
#include "tests/proof/explore/gate_explorer.hpp"
#include "tests/proof/explore/plans.hpp"

namespace biopsy::safety {
namespace {

Hash* taken = nullptr;  // where the steps go: a subject is plain functions

void step_and_note(const PlanFacts* plan, const SupervisorState* state, const SupervisorInput* input,
                   SupervisorState* next, SupervisorOutput* output) {
  explore::shipped().step(plan, state, input, next, output);
  const Permit& p = output->permit;
  taken->add(next->mode, next->last_event, next->reason, next->stage_done, next->arm_was_down,
             next->reset_was_down, next->session, next->epoch, next->seq, next->token, next->stage,
             next->ticks_in_mode, next->ticks_since_held, next->held_mV);
  taken->add(p.session, p.epoch, p.seq, p.issued_us, p.ttl_us, p.mode, p.stop, p.hv_enable, p.v_max_mV,
             p.slew_up_mV_per_tick, p.depth_max_um, p.plan_tag, p.config_tag, p.challenge);
  taken->add(output->event, output->worst, output->reason, output->refusal, output->stage, output->stage_done,
             output->image_allowed, output->image_disturbed, output->interlock_pulse);
}

void gate_and_note(const GateState* state, const DriveRequest* request, const Permit* permit,
                   std::int64_t now_us, std::int32_t writer_count, GateState* next, std::int32_t* mV,
                   bool* hv_enabled, GateVerdict* verdict) {
  explore::shipped().gate(state, request, permit, now_us, writer_count, next, mV, hv_enabled, verdict);
  taken->add(next->permit.session, next->permit.epoch, next->permit.seq, next->permit.ttl_us, next->permit_us,
             next->now_us, next->request_seq, next->drive_mV, next->enabled, next->started, next->latched,
             *mV, *hv_enabled, *verdict);
}

constexpr explore::Subject kSubject{step_and_note, gate_and_note};

}  // namespace

void hash_reachable_steps(Hash& hash) {
  taken = &hash;
  for (const explore::NamedPlan& plan : explore::few_plans()) {
    const explore::Exploration walk = explore::Explorer(kSubject, plan.facts, {}).run();
    hash.add(walk.transitions, walk.states);
  }
}

void hash_reachable_gates(Hash& hash) {
  taken = &hash;
  const explore::GateExploration walk = explore::explore_gate(kSubject, true, 0);
  hash.add(walk.transitions, walk.states);
}

}  // namespace biopsy::safety
