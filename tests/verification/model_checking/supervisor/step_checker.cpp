#include "tests/verification/model_checking/supervisor/step_checker.hpp"

#include <bit>
#include <utility>

#include "tests/verification/model_checking/supervisor/states.hpp"

namespace biopsy::model_checking {

StepChecker::Taken StepChecker::take(std::uint32_t from, const SupervisorState& before, const Situation& input,
                                     std::uint32_t index) {
  // First what the second step reads: it is in memory by then.
  write_equivalent_step(before, input, (std::uint64_t{from} << 32U) + index, equivalent_);
  Taken taken{subject_.step(&plan_, &before, &input), 0};
  const auto& [after, output] = taken.step;
  taken.key = key_of(after);
  ++steps_;
  note(check_all({plan_, before, input, after, output}), from, index);
  const Stepped other = subject_.step(&plan_, &equivalent_.state, &equivalent_.input);
  if (!has_equal_outcome(taken.key, taken.step, equivalent_.state, other))
    tallies_.break_claim(GraphClaim::ForgottenDecidesNothing, {from, index, {}});
  return taken;
}

// Which invariants applied is the same for long runs of inputs: counted by the run.
void StepChecker::note(Findings findings, std::uint32_t from, std::uint32_t index) {
  if (findings.applied != applied_) count_applied(), applied_ = findings.applied;
  ++applied_times_;
  for (std::uint64_t broken = findings.broken; broken != 0; broken &= broken - 1)
    tallies_.break_claim(static_cast<std::size_t>(std::countr_zero(broken)), {from, index, {}});
}

void StepChecker::count_applied() {
  for (std::uint64_t bits = applied_; bits != 0; bits &= bits - 1)
    tallies_.claims[static_cast<std::size_t>(std::countr_zero(bits))].checked += applied_times_;
  applied_times_ = 0;
}

Tallies StepChecker::take_tallies() {
  count_applied();
  return std::exchange(tallies_, {});
}

}  // namespace biopsy::model_checking
