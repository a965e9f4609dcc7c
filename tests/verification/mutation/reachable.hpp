// Every step of the supervisor, or of the gate, that the exploration takes from its start
// (tests/verification/model_checking): the reachable relation at its abstraction.
#pragma once

#include <vector>

#include "relation_hash.hpp"

namespace biopsy::safety {

// Of `suspects` those mutants are left that did the same as the code without a mutant at every step: by
// induction, what they reach is what it reaches. None of them may be in what is filled before main(). Without
// suspects the mutant that is active in this process takes the walk alone.
void walk_reachable_steps(Hash& hash, std::vector<int>& suspects);
void walk_reachable_gates(Hash& hash, std::vector<int>& suspects);

}  // namespace biopsy::safety
