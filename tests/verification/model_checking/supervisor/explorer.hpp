// Breadth-first, from the start, over every state the supervisor can reach and every input, tick by tick.
//
// In each state at an edge of time (states.hpp) every input of the product is tried, each with an equivalent,
// and each pair of inputs of which one is worse is compared. At the ticks between, one input of each kind
// that the first tick distinguished is tried and others, and each must do what it does in the first tick. The
// timer is exact: no time is skipped.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "tests/safety/situation.hpp"
#include "tests/verification/model_checking/subject.hpp"
#include "tests/verification/model_checking/supervisor/inputs.hpp"
#include "tests/verification/model_checking/supervisor/state_index.hpp"
#include "tests/verification/model_checking/supervisor/states.hpp"
#include "tests/verification/model_checking/sweep/step_checker.hpp"
#include "tests/verification/model_checking/sweep/sweep.hpp"
#include "tests/verification/model_checking/sweep/tallies.hpp"

namespace biopsy::model_checking {

struct Exploration {
  std::uint64_t transitions = 0;       // steps taken and checked against every invariant
  std::uint64_t equivalent_steps = 0;  // and steps of equivalent_steps beside them
  std::uint64_t pairs = 0;             // inputs compared with a worse one
  std::uint64_t states = 0;            // with exact timers
  std::array<std::uint64_t, safety::kModes> states_of_mode{};
  std::array<std::int32_t, safety::kModes> longest_ticks{};  // in Boot, Armed, Hold, Retract: longest stay
  std::uint32_t longest_to_safe_ticks = 0;
  Tallies tallies;
};

struct ExploreOptions {
  Grain grain = Grain::Quick;
  std::uint64_t enough = 0;   // violations after which to stop; 0: never
  std::uint64_t excused = 0;  // bit i: claim i does not count towards that
  Spread spread = one_by_one;
};

class Explorer {
 public:
  Explorer(const Subject& subject, const PlanFacts& plan, const ExploreOptions& options);
  Explorer(const Explorer&) = delete;  // its checker points into it
  Explorer& operator=(const Explorer&) = delete;

  Exploration run();

  // Inputs from the start to a state, oldest first, to be read with inputs_of(mode it was in).
  std::vector<std::uint32_t> way_to(std::uint32_t state) const;
  const InputSpace& inputs_of(Mode mode) const { return spaces_[static_cast<std::size_t>(mode)]; }
  SupervisorState state(std::uint32_t index) const { return state_of(keys_[index]); }

 private:
  void sweep_all(std::uint32_t from);
  void walk(std::uint32_t from, const std::vector<Kind>& kinds);
  void walk(std::uint32_t from, const SupervisorState& before, const Kind& kind);
  void go(std::uint32_t from, const Kind& kind);
  void check_graph();
  void check_safe_reachable();
  bool is_enough() const;

  Subject subject_;
  PlanFacts plan_;
  ExploreOptions options_;
  std::vector<InputSpace> spaces_;
  StepChecker checker_{subject_, plan_};
  Exploration result_;
  StateIndex index_;
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> parents_, via_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> healthy_;  // steps that a healthy script may take
  std::unordered_map<std::uint64_t, std::vector<Kind>> kinds_;    // by key without timer
};

}  // namespace biopsy::model_checking
