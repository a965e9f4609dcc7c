#include <fmt/format.h>

#include <algorithm>
#include <mutex>

#include "robot/common/in_parallel.hpp"
#include "tests/verification/model_checking/checks.hpp"
#include "tests/verification/model_checking/supervisor/counterexample.hpp"
#include "tests/verification/model_checking/supervisor/explorer.hpp"
#include "tests/verification/model_checking/supervisor/plans.hpp"

namespace biopsy::model_checking {
namespace {

struct PlanResult {
  NamedPlan plan;
  Exploration exploration;
  std::array<std::string, kClaims> counterexamples;
};

std::vector<PlanResult> explore_all(bool quick) {
  std::vector<PlanResult> results;
  for (NamedPlan& plan : quick ? quick_plans() : all_plans()) results.push_back({std::move(plan), {}, {}});
  std::mutex mutex;
  in_parallel(results.size(), [&](std::size_t i) {
    PlanResult& result = results[i];
    Explorer explorer(shipped(), result.plan.facts, {result.plan.grain, 0, 0, in_parallel});
    result.exploration = explorer.run();
    for (std::size_t c = 0; c < kClaims; ++c)
      if (result.exploration.tallies.claims[c].first)
        result.counterexamples[c] =
            counterexample_text(shipped(), result.plan.facts, explorer, result.exploration, c);
    const std::lock_guard lock(mutex);
    fmt::print(stderr, "supervisor, {}: {} transitions, {} states\n", result.plan.name,
               result.exploration.transitions, result.exploration.states);
  });
  return results;
}

// One row a claim over all plans; a plan without steps rises nowhere, so not every claim speaks in each.
void add_claims(EvidenceReport& report, const std::vector<PlanResult>& results) {
  for (std::size_t c = 0; c < kClaims; ++c) {
    std::uint64_t checked = 0, broken = 0;
    for (const PlanResult& result : results) {
      checked += result.exploration.tallies.claims[c].checked;
      broken += result.exploration.tallies.claims[c].broken;
    }
    report.tables["invariants"].push_back({{"name", name_of_claim(c)},
                                           {"sentence", sentence_of_claim(c)},
                                           {"checked", checked},
                                           {"violations", broken}});
    report.require(checked > 0 && broken == 0);
    const auto first =
        std::ranges::find_if(results, [c](const PlanResult& r) { return !r.counterexamples[c].empty(); });
    if (first == results.end()) continue;
    report.tables["counterexamples"].push_back({{"claim", name_of_claim(c)},
                                                {"plan", first->plan.name},
                                                {"counterexample", first->counterexamples[c]}});
    fmt::print("{}\n{}\n", first->plan.name, first->counterexamples[c]);
  }
}

void add_figures(EvidenceReport& report, const std::vector<PlanResult>& results) {
  std::uint64_t transitions = 0, equivalent_steps = 0, pairs = 0, states = 0, violations = 0;
  for (const PlanResult& result : results) {
    transitions += result.exploration.transitions;
    equivalent_steps += result.exploration.equivalent_steps;
    pairs += result.exploration.pairs;
    states += result.exploration.states;
    violations += result.exploration.tallies.broken();
  }
  const auto longest = [&](Mode mode) {
    std::int32_t ticks = 0;
    for (const PlanResult& r : results)
      ticks = std::max(ticks, r.exploration.longest_ticks[static_cast<std::size_t>(mode)]);
    return ticks;
  };
  std::uint32_t backward_reachability = 0;
  for (const PlanResult& r : results)
    backward_reachability = std::max(backward_reachability, r.exploration.longest_to_safe_ticks);
  report.figures["supervisor_plans"] = results.size();
  report.figures["supervisor_transitions"] = transitions;
  report.figures["supervisor_equivalent_steps"] = equivalent_steps;
  report.figures["supervisor_pairs"] = pairs;
  report.figures["supervisor_states"] = states;
  report.figures["supervisor_violations"] = violations;
  report.figures["longest_boot_ms"] = longest(Mode::Boot);
  report.figures["longest_armed_ms"] = longest(Mode::Armed);
  report.figures["longest_hold_ms"] = longest(Mode::Hold);
  report.figures["longest_retract_ms"] = longest(Mode::Retract);
  report.figures["longest_to_safe_ms"] = backward_reachability;
}

}  // namespace

void check_supervisor(EvidenceReport& report, bool quick) {
  const Stopwatch time;
  const std::vector<PlanResult> results = explore_all(quick);
  for (const PlanResult& result : results)
    report.tables["plans"].push_back({{"plan", result.plan.name},
                                      {"inputs", name_of(result.plan.grain)},
                                      {"transitions", result.exploration.transitions},
                                      {"states", result.exploration.states},
                                      {"violations", result.exploration.tallies.broken()}});
  add_figures(report, results);
  add_claims(report, results);
  report.figures["supervisor_seconds"] = time.seconds();
}

}  // namespace biopsy::model_checking
