// The relation of supervisor and gate over all that is reachable, by the exploration's own walk.
#include "reachable.hpp"

#include <vector>

#include "mutation.hpp"
#include "relation_hash.hpp"
#include "tests/safety/situation.hpp"
#include "tests/verification/model_checking/gate/gate_explorer.hpp"
#include "tests/verification/model_checking/supervisor/explorer.hpp"
#include "tests/verification/model_checking/supervisor/plans.hpp"

namespace biopsy::safety {
namespace {

// Where the steps go: a subject is plain functions.
Hash* taken = nullptr;
std::vector<int>* alike = nullptr;  // mutants that did the same at every step so far

struct Stepped {
  explicit Stepped(const model_checking::Stepped& done) : next(done.first), output(done.second) {}
  SupervisorState next;
  SupervisorOutput output;

  std::uint64_t digest() const {
    Hash hash;
    hash.add(next.mode, next.last_event, next.reason, next.step_done, next.arm_was_down, next.reset_was_down,
             next.session, next.epoch, next.seq, next.token, next.step, next.arrived_seq, next.ms_in_mode,
             next.ms_since_held, next.held_mV);
    const Permit& p = output.permit;
    hash.add(p.session, p.epoch, p.seq, p.issued_us, p.ttl_us, p.mode, p.stop, p.hv_enable, p.v_max_mV,
             p.slew_up_mV_per_tick, p.depth_max_um, p.brake, p.plan_tag, p.config_tag, p.challenge);
    hash.add(output.event, output.worst, output.reason, output.refusal, output.step, output.step_done,
             output.image_allowed, output.image_disturbed, output.interlock_pulse);
    return hash.value();
  }
};

struct Gated {
  GateState next;
  std::int32_t mV = 0;
  bool hv_enabled = false, brake_on = false;
  GateVerdict verdict = GateVerdict::NoPermit;

  std::uint64_t digest() const {
    Hash hash;
    hash.add(next.permit.session, next.permit.epoch, next.permit.seq, next.permit.ttl_us, next.permit_us,
             next.now_us, next.request_seq, next.drive_mV, next.enabled, next.brake_on, next.started,
             next.latched, mV, hv_enabled, brake_on, verdict);
    return hash.value();
  }
};

// `step` as this process has it and then, from the same start, as each of the mutants that it reached.
template <class Step>
auto take(const Step& step) {
  for (const int mutant : *alike) mutation::reached[static_cast<std::size_t>(mutant)] = false;
  const auto original = step();
  const std::uint64_t digest = original.digest();
  taken->add(digest);
  const int was_active = mutation::active;
  std::erase_if(*alike, [&](int mutant) {
    if (!mutation::reached[static_cast<std::size_t>(mutant)]) return false;
    mutation::active = mutant;
    return step().digest() != digest;
  });
  mutation::active = was_active;
  return original;
}

model_checking::Stepped step_and_note(const PlanFacts* plan, const SupervisorState* state,
                                      const Situation* input) {
  const Stepped done = take([&] { return Stepped{model_checking::shipped().step(plan, state, input)}; });
  return {done.next, done.output};
}

void gate_and_note(const GateState* state, const DriveRequest* request, const Permit* permit,
                   std::int64_t now_us, std::int32_t writer_count, GateState* next, std::int32_t* mV,
                   bool* hv_enabled, bool* brake_on, GateVerdict* verdict) {
  const Gated done = take([&] {
    Gated gated;
    model_checking::shipped().gate(state, request, permit, now_us, writer_count, &gated.next, &gated.mV,
                                   &gated.hv_enabled, &gated.brake_on, &gated.verdict);
    return gated;
  });
  *next = done.next, *mV = done.mV, *hv_enabled = done.hv_enabled, *brake_on = done.brake_on,
  *verdict = done.verdict;
}

constexpr model_checking::Subject kSubject{step_and_note, gate_and_note};

void begin(Hash& hash, std::vector<int>& suspects) {
  taken = &hash, alike = &suspects;
  if (!suspects.empty()) mutation::active = mutation::kRecording;
}

}  // namespace

void walk_reachable_steps(Hash& hash, std::vector<int>& suspects) {
  begin(hash, suspects);
  for (const model_checking::NamedPlan& plan : model_checking::quick_plans()) {
    const model_checking::Exploration walk = model_checking::Explorer(kSubject, plan.facts, {}).run();
    hash.add(walk.transitions, walk.states);
  }
}

void walk_reachable_gates(Hash& hash, std::vector<int>& suspects) {
  begin(hash, suspects);
  const model_checking::GateExploration walk = model_checking::explore_gate(kSubject, true, 0);
  hash.add(walk.transitions, walk.states);
}

}  // namespace biopsy::safety
