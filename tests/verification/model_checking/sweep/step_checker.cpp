#include "tests/verification/model_checking/sweep/step_checker.hpp"

#include <bit>
#include <utility>

#include "tests/verification/model_checking/supervisor/states.hpp"

namespace biopsy::model_checking {

Stepped StepChecker::take(std::uint32_t from, const SupervisorState& before, const Situation& input,
                          std::uint32_t index, std::uint64_t& key) {
  // First what the second step reads: it is in memory by then.
  const std::uint64_t number = (std::uint64_t{from} << 32U) + index;
  write_equivalent_step(before, input, number, equivalent_);
  Stepped step = subject_.step(&plan_, &before, &input);
  const auto& [after, output] = step;
  key = key_of(after);
  ++steps_;
  note(check_all({plan_, before, input, after, output}), from, index);
  const Stepped other =
      subject_.step(&equivalent_plans_.of(before, number), &equivalent_.state, &equivalent_.input);
  if (!has_equal_outcome(key, step, equivalent_, other))
    tallies_.break_claim(GraphClaim::ForgottenDecidesNothing, {from, index, {}});
  return step;
}

// Few sets of invariants apply in a state: counted by the set.
void StepChecker::note(Findings findings, std::uint32_t from, std::uint32_t index) {
  Applied& applied = applied_[findings.applied * 0x9E37'79B9'7F4A'7C15ULL >> (64U - kAppliedBits)];
  if (applied.claims != findings.applied) count(applied), applied.claims = findings.applied;
  ++applied.times;
  for (std::uint64_t broken = findings.broken; broken != 0; broken &= broken - 1)
    tallies_.break_claim(static_cast<std::size_t>(std::countr_zero(broken)), {from, index, {}});
}

void StepChecker::count(Applied& applied) {
  for (std::uint64_t bits = applied.claims; bits != 0 && applied.times != 0; bits &= bits - 1)
    tallies_.claims[static_cast<std::size_t>(std::countr_zero(bits))].checked += applied.times;
  applied.times = 0;
}

Tallies StepChecker::take_tallies() {
  for (Applied& applied : applied_) count(applied);
  return std::exchange(tallies_, {});
}

}  // namespace biopsy::model_checking
