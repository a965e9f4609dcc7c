#include "find_violation.hpp"

#include <algorithm>

#include "counterexample.hpp"
#include "explorer.hpp"
#include "gate_explorer.hpp"
#include "plans.hpp"

namespace biopsy::explore {
namespace {

constexpr std::uint64_t kEnough = 1'000;

bool is_in(const std::vector<std::string>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

Catch hunt_in_supervisor(const Subject& subject, const PlanFacts& plan,
                         const std::vector<std::string>& known) {
  std::uint64_t excused = 0;
  for (std::size_t c = 0; c < kClaims; ++c) excused |= std::uint64_t{is_in(known, name_of_claim(c))} << c;
  Explorer explorer(subject, plan, {Grain::Quick, kEnough, excused});
  const Exploration exploration = explorer.run();
  Catch found;
  for (std::size_t c = 0; c < kClaims; ++c) {
    if (!exploration.claims[c].first || is_in(known, name_of_claim(c))) continue;
    found.claims.emplace_back(name_of_claim(c));
    found.stories.push_back(story_of(subject, plan, explorer, exploration, c));
  }
  return found;
}

Catch hunt_in_gate(const Subject& subject, const std::vector<std::string>& known) {
  const GateExploration exploration = explore_gate(subject, true, kEnough);
  Catch found;
  for (std::size_t c = 0; c < kGateInvariants; ++c) {
    if (exploration.claims[c].broken == 0 || is_in(known, kGateInvariantTable[c].name)) continue;
    found.claims.emplace_back(kGateInvariantTable[c].name);
    found.stories.push_back(exploration.claims[c].counterexample);
  }
  return found;
}

}  // namespace

Catch find_violation(const Subject& subject, Part part, const std::vector<std::string>& known) {
  if (part == Part::Gate) return hunt_in_gate(subject, known);
  Catch found = hunt_in_supervisor(subject, three_stages(0b010).facts, known);
  return found.claims.empty() ? hunt_in_supervisor(subject, greedy().facts, known) : found;
}

}  // namespace biopsy::explore
