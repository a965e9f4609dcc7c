#include <fmt/format.h>

#include "tests/verification/model_checking/checks.hpp"
#include "tests/verification/model_checking/gate/gate_explorer.hpp"

namespace biopsy::model_checking {

void check_gate(EvidenceReport& report, bool quick) {
  const Stopwatch time;
  const GateExploration exploration = explore_gate(shipped(), quick, 0);
  for (std::size_t c = 0; c < kGateInvariants; ++c) {
    const GateTally& tally = exploration.claims[c];
    report.tables["gate_invariants"].push_back({{"name", kGateInvariantTable[c].name},
                                                {"sentence", kGateInvariantTable[c].sentence},
                                                {"checked", tally.checked},
                                                {"violations", tally.broken}});
    report.require(tally.checked > 0 && tally.broken == 0);
    if (tally.broken == 0) continue;
    report.tables["counterexamples"].push_back(
        {{"claim", kGateInvariantTable[c].name}, {"plan", ""}, {"counterexample", tally.counterexample}});
    fmt::print("{}\n", tally.counterexample);
  }
  report.figures["gate_transitions"] = exploration.transitions;
  report.figures["gate_states"] = exploration.states;
  report.figures["gate_violations"] = exploration.violations();
  report.figures["gate_seconds"] = time.seconds();
  fmt::print(stderr, "gate: {} transitions, {} states\n", exploration.transitions, exploration.states);
}

}  // namespace biopsy::model_checking
