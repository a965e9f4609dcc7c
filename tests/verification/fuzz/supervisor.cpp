// The supervisor's step from any memory, under any plan and inputs: it always answers, and never allows what
// no permit may allow.
#include "safety/supervisor.hpp"

#include "tests/safety/situation.hpp"
#include "tests/verification/fuzz/safety_values.hpp"

FUZZ(supervisor) {
  using namespace biopsy;
  using namespace biopsy::fuzz;
  Feed feed(bytes);
  safety::PlanFacts plan;
  fill(feed, plan);
  safety::SupervisorState state = safety::started(1);
  if (feed.any<bool>()) fill(feed, state);
  safety::Situation input;
  do {
    const auto what = feed.any<std::uint8_t>();
    if (what & 1) fill(feed, input);
    if (what & 2) input.evidence.clear = safety::kAllHazards, input.evidence.zero_volts = true;
    if (what & 4) input.self_test = safety::SelfTest::Passed;
    if (what & 8) input.local_arm = !input.local_arm;
    if (what & 16) input.motion = {input.motion.token + 1, true};
    if (what & 32) input.evidence.zero_volts = !input.evidence.zero_volts;
    if (what & 64) input.stop = static_cast<StopCategory>(what >> 7);
    const auto [next, output] = safety::step(plan, state, input);
    claim_sound(output.permit);
    const bool c0 = (input.evidence.hazards() & safety::hazards_with(StopCategory::C0Off)) != 0;
    claim(!c0 || !output.permit.hv_enable, "C0 switches off in the same tick");
    claim(state.mode != Mode::Lock || next.mode == Mode::Lock, "Lock absorbs");
    claim(next.mode != Mode::Active || state.mode == Mode::Active || state.mode == Mode::Armed ||
              state.mode == Mode::Hold,
          "Active is entered only from Armed or Hold");
    claim(!name_of(output.refusal).empty() && !safety::name_of(output.event).empty(),
          "every answer has a name");
    state = next;
  } while (!feed.empty());
}
