// Breadth-first over every state of the gate and every input, from its start.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/verification/model_checking/gate/gate_invariants.hpp"
#include "tests/verification/model_checking/gate/gate_space.hpp"
#include "tests/verification/model_checking/subject.hpp"

namespace biopsy::model_checking {

struct GateTally {
  std::uint64_t checked = 0, broken = 0;
  std::string counterexample;  // of the first time it broke
};

struct GateExploration {
  std::uint64_t transitions = 0, states = 0;
  std::array<GateTally, kGateInvariants> claims;
  std::uint64_t violations() const;
};

// `enough`: violations after which to stop; 0: never.
GateExploration explore_gate(const Subject& subject, bool quick, std::uint64_t enough);

}  // namespace biopsy::model_checking
