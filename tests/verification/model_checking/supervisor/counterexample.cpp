#include "tests/verification/model_checking/supervisor/counterexample.hpp"

#include <fmt/format.h>

#include "tests/safety/situation.hpp"
#include "tests/verification/model_checking/supervisor/equivalent_step.hpp"

namespace biopsy::model_checking {
namespace {

std::string seconds(std::size_t ticks) {
  return ticks < 1'000 ? fmt::format("{} ms", ticks)
                       : fmt::format("{:.3f} s", static_cast<double>(ticks) / 1'000);
}

std::string motion_text(const SupervisorState& state, const safety::MotionPress& motion) {
  if (motion.token == 0) return "";
  const char* doing = motion.held ? "held" : "let go";
  if (motion.token > state.token) return fmt::format("motion button {} (new press)", doing);
  if (motion.token == state.token) return fmt::format("motion button {} (present press)", doing);
  return fmt::format("motion button {} (an old press)", doing);
}

std::string hazard_text(safety::HazardSet hazards) {
  std::string words;
  for (std::size_t h = 0; h < safety::kHazards; ++h)
    if (const auto hazard = static_cast<safety::Hazard>(h); (hazards & safety::bit(hazard)) != 0)
      words += fmt::format("{}{}", words.empty() ? "" : " + ", safety::name_of(hazard));
  return words;
}

// Only what is not as in a quiet healthy tick of this mode.
std::string input_text(const SupervisorState& state, const Situation& input) {
  std::string words;
  const auto say = [&words](const std::string& word) {
    if (!word.empty()) words += (words.empty() ? "" : ", ") + word;
  };
  constexpr const char* kStops[] = {"", "stop C2 asked", "stop C1 asked", "stop C0 asked"};
  const auto step_text = [&](std::uint32_t step) {
    return step == state.step ? "this step" : "another step";
  };
  say(hazard_text(input.evidence.hazards()));
  say(kStops[static_cast<std::size_t>(input.stop)]);
  if (state.mode != Mode::Active && state.mode != Mode::Hold)  // where it decides
    say(input.evidence.zero_volts ? "0 V measured" : "voltage measured");
  if (!input.evidence.needle_home) say("needle out");
  if (state.mode == Mode::Boot && input.self_test != safety::SelfTest::Passed)
    say(input.self_test == safety::SelfTest::Failed ? "self-test failed" : "self-test pending");
  if (input.local_arm) say("arm key turned");
  if (input.local_reset) say("reset key turned");
  if (input.remote_arm || input.remote_reset) say("arm or reset asked over the network");
  say(motion_text(state, input.motion));
  if (input.request.step_reached) say(fmt::format("controller reached {}", step_text(input.request.step)));
  if (input.request.finished) say("controller finished");
  if (input.depth_accepted)
    say(fmt::format("depth check accepts {}, image from {}", step_text(input.accepted_step),
                    input.accepted_since_seq));
  if (input.evidence.drive_mV != 0) say(fmt::format("{} V on the drive", input.evidence.drive_mV / 1'000));
  return words.empty() ? "nothing new" : words;
}

std::string permit_text(const SupervisorState& next, const SupervisorOutput& output) {
  const Permit& permit = output.permit;
  std::string words{safety::name_of(next.mode)};
  if (output.event != safety::Event::None) words += fmt::format(" ({})", safety::name_of(output.event));
  if (next.mode == Mode::Active || next.mode == Mode::Hold)
    words += fmt::format(", step {}{}", next.step + 1, next.step_done ? " done" : "");
  if (permit.hv_enable) words += fmt::format(", up to {} V", permit.v_max_mV / 1'000);
  if (permit.slew_up_mV_per_tick > 0) words += ", may rise";
  if (output.refusal != safety::Refusal::None)
    words += fmt::format(", refuses: {}", safety::name_of(output.refusal));
  return words;
}

// Writes ticks with the same words as one line.
class TraceWriter {
 public:
  void add(const std::string& line) {
    if (line != line_) flush(), line_ = line;
    ++ticks_;
  }
  std::string end() { return flush(), text_; }

 private:
  void flush() {
    if (ticks_ > 0)
      text_ += fmt::format("  {:>9}  {}{}\n", seconds(at_), ticks_ > 1 ? "for " + seconds(ticks_) + ": " : "",
                           line_);
    at_ += ticks_;
    ticks_ = 0;
  }
  std::string text_, line_;
  std::size_t at_ = 0, ticks_ = 0;
};

}  // namespace

std::string counterexample_text(const Subject& subject, const PlanFacts& plan, const Explorer& explorer,
                                const Exploration& exploration, std::size_t claim) {
  const Counterexample found = exploration.tallies.claims[claim].first.value();
  std::vector<std::uint32_t> way = explorer.way_to(found.state);
  SupervisorState state = safety::started(kSession), next;
  TraceWriter trace;
  const PlanFacts* facts = &plan;
  const auto step = [&](const Situation& input) {
    const auto [after, output] = subject.step(facts, &state, &input);
    next = after;
    return fmt::format("{} | {} -> {}", safety::name_of(state.mode), input_text(state, input),
                       permit_text(next, output));
  };
  for (const std::uint32_t index : way) {
    trace.add(step(explorer.inputs_of(state.mode).at(index, state)));
    state = next;
  }
  const bool is_of_a_state =
      claim == number_of(GraphClaim::SafeReachable) || claim == number_of(GraphClaim::EveryModeReached);
  const Situation last = explorer.inputs_of(state.mode).at(found.input, state);
  if (!is_of_a_state) trace.add(step(last));
  std::string text = trace.end();
  if (found.worse)
    text += "  instead:   " + step(explorer.inputs_of(state.mode).at(*found.worse, state)) + "\n";
  if (claim == number_of(GraphClaim::ForgottenDecidesNothing)) {
    const std::uint64_t number = (std::uint64_t{found.state} << 32U) + found.input;
    const EquivalentStep equivalent = equivalent_step(state, last, number);
    const EquivalentPlans plans(plan);
    facts = &plans.of(state, number);
    state = equivalent.state;
    text += "  an equivalent:    " + step(equivalent.input) + "\n";
  }
  return fmt::format("{}  broken:    {}: {}\n", text, name_of_claim(claim), sentence_of_claim(claim));
}

}  // namespace biopsy::model_checking
