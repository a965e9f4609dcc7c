// Every input of the product in one state, each step checked, and each pair of inputs of which one is worse
// compared. Runs of inputs are taken side by side; the result does not depend on it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tests/verification/model_checking/subject.hpp"
#include "tests/verification/model_checking/supervisor/inputs.hpp"
#include "tests/verification/model_checking/sweep/tallies.hpp"

namespace biopsy::model_checking {

// Does the work for each of `count` numbers, side by side if it likes.
using Spread = void (*)(std::size_t count, const std::function<void(std::size_t)>& work);
inline void one_by_one(std::size_t count, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = 0; i < count; ++i) work(i);
}

// The first input of those that a step cannot tell apart by what it did.
struct Kind {
  std::uint32_t index;
  Situation input;
  std::uint64_t key;  // of the state after
};

// All hazards absent, and so on: what a script that wants to go on to Safe may send.
bool is_healthy(const Situation& input);

struct Sweep {
  std::vector<Kind> kinds;  // in order of index
  std::uint64_t steps = 0;  // as many as there are inputs
  std::uint64_t pairs = 0;  // inputs compared with a worse one
  Tallies tallies;
};

Sweep sweep(const Subject& subject, const PlanFacts& plan, const InputSpace& space, std::uint32_t from,
            const SupervisorState& before, Spread spread);

}  // namespace biopsy::model_checking
