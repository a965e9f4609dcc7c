#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <mutex>

#include "counterexample.hpp"
#include "explorer.hpp"
#include "parts.hpp"
#include "plans.hpp"
#include "robot/common/in_parallel.hpp"

namespace biopsy::explore {
namespace {

struct PlanResult {
  NamedPlan plan;
  Grain grain;
  Exploration exploration;
  std::array<std::string, kClaims> stories;
};

std::vector<PlanResult> explore_all(bool quick) {
  std::vector<PlanResult> results;
  for (NamedPlan& plan : quick ? few_plans() : all_plans())
    results.push_back({std::move(plan), Grain::Quick, {}, {}});
  if (!quick) results.front().grain = Grain::Full;
  std::mutex mutex;
  in_parallel(results.size(), [&](std::size_t i) {
    PlanResult& result = results[i];
    Explorer explorer(shipped(), result.plan.facts, {result.grain, 0, 0});
    result.exploration = explorer.run();
    for (std::size_t c = 0; c < kClaims; ++c)
      if (result.exploration.claims[c].first)
        result.stories[c] = story_of(shipped(), result.plan.facts, explorer, result.exploration, c);
    const std::lock_guard lock(mutex);
    fmt::print(stderr, "supervisor, {}: {} transitions, {} states\n", result.plan.name,
               result.exploration.transitions, result.exploration.states);
  });
  return results;
}

// One row a claim over all plans; a plan without stages rises nowhere, so not every claim speaks in each.
void add_claims(Report& report, const std::vector<PlanResult>& results) {
  for (std::size_t c = 0; c < kClaims; ++c) {
    std::uint64_t checked = 0, broken = 0;
    for (const PlanResult& result : results) {
      checked += result.exploration.claims[c].checked;
      broken += result.exploration.claims[c].broken;
    }
    report.tables["invariants"].push_back({{"name", name_of_claim(c)},
                                           {"sentence", sentence_of_claim(c)},
                                           {"checked", checked},
                                           {"violations", broken}});
    report.require(checked > 0 && broken == 0);
    const auto first =
        std::ranges::find_if(results, [c](const PlanResult& r) { return !r.stories[c].empty(); });
    if (first == results.end()) continue;
    report.tables["stories"].push_back(
        {{"claim", name_of_claim(c)}, {"plan", first->plan.name}, {"counterexample", first->stories[c]}});
    fmt::print("{}\n{}\n", first->plan.name, first->stories[c]);
  }
}

void add_figures(Report& report, const std::vector<PlanResult>& results) {
  std::uint64_t transitions = 0, twins = 0, pairs = 0, states = 0, violations = 0;
  for (const PlanResult& result : results) {
    transitions += result.exploration.transitions;
    twins += result.exploration.twins;
    pairs += result.exploration.pairs;
    states += result.exploration.states;
    violations += result.exploration.violations();
  }
  const auto longest = [&](Mode mode) {
    std::int32_t ticks = 0;
    for (const PlanResult& r : results)
      ticks = std::max(ticks, r.exploration.longest_ticks[static_cast<std::size_t>(mode)]);
    return ticks;
  };
  std::uint32_t backward_reachability = 0;
  for (const PlanResult& r : results)
    backward_reachability = std::max(backward_reachability, r.exploration.longest_way_home_ticks);
  report.figures["supervisor_plans"] = results.size();
  report.figures["supervisor_transitions"] = transitions;
  report.figures["supervisor_twins"] = twins;
  report.figures["supervisor_pairs"] = pairs;
  report.figures["supervisor_states"] = states;
  report.figures["supervisor_violations"] = violations;
  report.figures["longest_boot_ms"] = longest(Mode::Boot);
  report.figures["longest_armed_ms"] = longest(Mode::Armed);
  report.figures["longest_hold_ms"] = longest(Mode::Hold);
  report.figures["longest_retract_ms"] = longest(Mode::Retract);
  report.figures["longest_way_home_ms"] = backward_reachability;
}

}  // namespace

void prove_supervisor(Report& report, bool quick) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<PlanResult> results = explore_all(quick);
  for (const PlanResult& result : results)
    report.tables["plans"].push_back({{"plan", result.plan.name},
                                      {"inputs", result.grain == Grain::Full ? "full" : "quick"},
                                      {"transitions", result.exploration.transitions},
                                      {"states", result.exploration.states},
                                      {"violations", result.exploration.violations()}});
  add_figures(report, results);
  add_claims(report, results);
  report.figures["supervisor_seconds"] =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace biopsy::explore
