#include "tests/verification/model_checking/seeded_bugs/find_violation.hpp"

#include <algorithm>

#include "robot/common/in_parallel.hpp"
#include "tests/verification/model_checking/gate/gate_explorer.hpp"
#include "tests/verification/model_checking/supervisor/counterexample.hpp"
#include "tests/verification/model_checking/supervisor/explorer.hpp"
#include "tests/verification/model_checking/supervisor/plans.hpp"

namespace biopsy::model_checking {
namespace {

constexpr std::uint64_t kEnough = 1'000;

bool is_in(const std::vector<std::string>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

Violations search_supervisor(const Subject& subject, const PlanFacts& plan, Grain grain,
                             const std::vector<std::string>& known) {
  std::uint64_t excused = 0;
  for (std::size_t c = 0; c < kClaims; ++c) excused |= std::uint64_t{is_in(known, name_of_claim(c))} << c;
  Explorer explorer(subject, plan, {grain, kEnough, excused, in_parallel});
  const Exploration exploration = explorer.run();
  Violations found;
  for (std::size_t c = 0; c < kClaims; ++c) {
    if (!exploration.tallies.claims[c].first || is_in(known, name_of_claim(c))) continue;
    found.claims.emplace_back(name_of_claim(c));
    found.counterexamples.push_back(counterexample_text(subject, plan, explorer, exploration, c));
  }
  return found;
}

Violations search_gate(const Subject& subject, const std::vector<std::string>& known) {
  const GateExploration exploration = explore_gate(subject, true, kEnough);
  Violations found;
  for (std::size_t c = 0; c < kGateInvariants; ++c) {
    if (exploration.claims[c].broken == 0 || is_in(known, kGateInvariantTable[c].name)) continue;
    found.claims.emplace_back(kGateInvariantTable[c].name);
    found.counterexamples.push_back(exploration.claims[c].counterexample);
  }
  return found;
}

}  // namespace

Violations find_violation(const Subject& subject, Part part, const std::vector<std::string>& known) {
  if (part == Part::Gate) return search_gate(subject, known);
  const PlanFacts plan = three_steps(0b010).facts;
  Violations found = search_supervisor(subject, plan, Grain::Thin, known);  // in a tenth of the time
  if (found.claims.empty()) found = search_supervisor(subject, plan, Grain::Quick, known);
  return found.claims.empty() ? search_supervisor(subject, over_limits().facts, Grain::Quick, known) : found;
}

}  // namespace biopsy::model_checking
