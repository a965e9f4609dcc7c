#include <fmt/format.h>

#include <chrono>

#include "gate_explorer.hpp"
#include "parts.hpp"

namespace biopsy::explore {

void prove_gate(Report& report, bool quick) {
  const auto start = std::chrono::steady_clock::now();
  const GateExploration exploration = explore_gate(shipped(), quick, 0);
  for (std::size_t c = 0; c < kGateInvariants; ++c) {
    const GateTally& tally = exploration.claims[c];
    report.tables["gate_invariants"].push_back({{"name", kGateInvariantTable[c].name},
                                                {"sentence", kGateInvariantTable[c].sentence},
                                                {"checked", tally.checked},
                                                {"violations", tally.broken}});
    report.require(tally.checked > 0 && tally.broken == 0);
    if (tally.broken == 0) continue;
    report.tables["stories"].push_back(
        {{"claim", kGateInvariantTable[c].name}, {"plan", ""}, {"counterexample", tally.counterexample}});
    fmt::print("{}\n", tally.counterexample);
  }
  report.figures["gate_transitions"] = exploration.transitions;
  report.figures["gate_states"] = exploration.states;
  report.figures["gate_violations"] = exploration.violations();
  report.figures["gate_seconds"] =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print(stderr, "gate: {} transitions, {} states\n", exploration.transitions, exploration.states);
}

}  // namespace biopsy::explore
