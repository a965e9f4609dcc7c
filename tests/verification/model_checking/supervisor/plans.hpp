// The plans that are explored: first, middle and last step are all that step can tell apart, so three
// steps.
#pragma once

#include <string>
#include <vector>

#include "safety/types/plan_facts.hpp"
#include "tests/verification/model_checking/supervisor/inputs.hpp"

namespace biopsy::model_checking {

struct NamedPlan {
  std::string name;
  safety::PlanFacts facts;
  Grain grain = Grain::Quick;  // of the inputs that are tried on it
};

// Bit i of `confirms`: an image must confirm step i.
NamedPlan three_steps(unsigned confirms);
// Its steps ask for more than the robot may do.
NamedPlan over_limits();
// No step at all.
NamedPlan empty();

// Every combination of confirmations, and the two odd ones. Two of them have each step with and without its
// confirmation, and equivalents show at each of their steps that those of the other steps decide nothing: the
// six others differ in the graph alone, and are explored with thin inputs.
std::vector<NamedPlan> all_plans();
// One combination, and the two odd ones.
std::vector<NamedPlan> quick_plans();

}  // namespace biopsy::model_checking
