// Takes steps, each checked against every invariant and with an equivalent beside it.
#pragma once

#include <array>
#include <cstdint>

#include "tests/verification/model_checking/subject.hpp"
#include "tests/verification/model_checking/supervisor/equivalent_step.hpp"
#include "tests/verification/model_checking/supervisor/invariants.hpp"
#include "tests/verification/model_checking/sweep/tallies.hpp"

namespace biopsy::model_checking {

class StepChecker {
 public:
  StepChecker(const Subject& subject, const PlanFacts& plan) : subject_(subject), plan_(plan) {}

  // From the state of number `from` by the input of number `index` of its mode's. `key`: of the state after.
  Stepped take(std::uint32_t from, const SupervisorState& before, const Situation& input, std::uint32_t index,
               std::uint64_t& key);

  std::uint64_t steps() const { return steps_; }
  // Of all steps since the last call.
  Tallies take_tallies();

 private:
  struct Applied {
    std::uint64_t claims = 0, times = 0;
  };
  void note(Findings findings, std::uint32_t from, std::uint32_t index);
  void count(Applied& applied);

  const Subject& subject_;
  const PlanFacts& plan_;
  EquivalentPlans equivalent_plans_{plan_};
  EquivalentStep equivalent_;
  Tallies tallies_;
  std::uint64_t steps_ = 0;
  static constexpr unsigned kAppliedBits = 8;
  std::array<Applied, 1U << kAppliedBits> applied_{};
};

}  // namespace biopsy::model_checking
