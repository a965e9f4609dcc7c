// What must hold in every step, one row each: name, sentence, check. The limits are written here once more,
// from the safety concept, so that a wrong constant in safety/ is seen as well.
#pragma once

#include <array>
#include <cstdint>

#include "safety/types/hazards.hpp"
#include "tests/safety/situation.hpp"
#include "tests/verification/model_checking/subject.hpp"

namespace biopsy::model_checking {

// One step of the supervisor, with what was asked and needed.
struct Step {
  const PlanFacts& plan;
  const SupervisorState& before;
  const Situation& input;
  const SupervisorState& after;
  const SupervisorOutput& output;
  safety::HazardSet hazards = input.evidence.hazards();
  StopCategory stop = strongest_stop(input);

  static StopCategory strongest_stop(const Situation& input);
  bool enters(Mode mode) const { return after.mode == mode && before.mode != mode; }
  bool leaves(Mode mode) const { return before.mode == mode && after.mode != mode; }
  bool stays(Mode mode) const { return before.mode == mode && after.mode == mode; }
  bool arm_edge() const { return input.local_arm && !before.arm_was_down; }
  bool reset_edge() const { return input.local_reset && !before.reset_was_down; }
};

struct Finding {
  bool applies;  // the claim is about this step
  bool holds;
};

struct Invariant {
  const char* name;
  const char* sentence;
  Finding (*check)(const Step&);
};

inline constexpr std::size_t kInvariants = 52;
extern const std::array<Invariant, kInvariants> kInvariantTable;

// Bit i: invariant i said something, invariant i is broken.
struct Findings {
  std::uint64_t applied = 0, broken = 0;
};
Findings check_all(const Step& step);

// |V| that a permit of this state allows: the step's limit under the ceiling, what is held, or the ramp.
std::int32_t envelope_mV(const PlanFacts& plan, const SupervisorState& state, const Situation& input);

}  // namespace biopsy::model_checking
