// An equivalent of a step differs from it in everything the exploration forgets: names of session, epoch and
// tokens, timers and voltages of other modes, which hazard of a class, which other steps of the plan an image
// confirms, inputs that decide nothing in this mode, what is asked over the network. It must do the same;
// that is what makes the abstraction sound.
#pragma once

#include <array>
#include <cstdint>

#include "tests/safety/situation.hpp"
#include "tests/verification/model_checking/subject.hpp"
#include "tests/verification/model_checking/supervisor/inputs.hpp"
#include "tests/verification/model_checking/supervisor/states.hpp"

namespace biopsy::model_checking {

struct EquivalentStep {
  SupervisorState state;
  Situation input;
};

// `number` chooses the differences; another number, another equivalent.
EquivalentStep equivalent_step(const SupervisorState& state, const Situation& input, std::uint64_t number);

// The same into one that an equivalent of the same input, or of another that differs in the dimensions of
// inputs.hpp alone, was written to before.
void write_equivalent_step(const SupervisorState& state, const Situation& input, std::uint64_t number,
                           EquivalentStep& equivalent);

// The plans of equivalents: all that differ from `plan` in which of its first steps an image confirms.
class EquivalentPlans {
 public:
  explicit EquivalentPlans(const PlanFacts& plan);
  // Confirms the present step as `plan` does.
  const PlanFacts& of(const SupervisorState& state, std::uint64_t number) const;

 private:
  static constexpr std::uint32_t kVaried = 3;   // steps
  std::array<PlanFacts, 1U << kVaried> plans_;  // bit i of the index: step i is confirmed unlike in `plan`
};

// Whether a step and its equivalent did the same, each seen from where it started, and the equivalent named
// its own hazard. `key`: of the state after the first.
bool has_equal_outcome(std::uint64_t key, const Stepped& step, const EquivalentStep& equivalent,
                       const Stepped& other_step);

}  // namespace biopsy::model_checking
