// Many corrupted procedures, in parallel, and the table of what became of them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/verification/fault_injection/evaluate.hpp"

namespace biopsy::fault_injection {

struct RunResult {
  Verdict verdict;
  Mode mode = Mode::Boot;         // in which the fault began
  std::int64_t tick = 0;          // at which
  std::vector<TickRecord> lines;  // from that tick on
};

// `masked`: hazards the supervisor is kept from hearing of, to show that this bench can fail.
struct Campaign {
  const NominalModels& models;
  std::uint64_t seed = 1;
  safety::HazardSet masked = 0;
  Observer observer = {};  // hears what supervisor and gate are given; from one thread at a time
};

// One run of a class: a scenario, its sound procedure to choose the moment from, and the same corrupted at
// that moment. Depends on the seed, the class and `run` alone; all classes of a run share the scenario.
RunResult run_one(const Campaign& campaign, const FaultClass& fault, std::uint64_t run);

struct Tally {
  const FaultClass* fault = nullptr;
  std::int32_t runs = 0, detected = 0, by_another = 0, late = 0, missed = 0, not_shown = 0;
  std::int32_t too_deep = 0, too_high = 0, rose = 0;
  std::int32_t detect_ms = 0, react_ms = 0, from_fault_ms = 0;  // worst
  double beyond_mm = -1e9, highest_kV = 0.0;                    // worst
  std::vector<std::uint64_t> bad;                               // runs to look at

  bool holds() const { return bad.empty() && runs == detected + by_another; }
  // Detected, by whichever hazard, of all runs: lower bound of its share with 95 % confidence.
  double coverage() const;
};

// Clopper and Pearson 1934, one-sided: the share p at which `most` or more of `runs` has 5 % probability.
double lower_bound_95(std::int32_t hits, std::int32_t runs);

// `progress` is events from several threads.
std::vector<Tally> run_all(const Campaign& campaign, const std::vector<FaultClass>& faults, std::int32_t runs,
                           const std::function<void(double share)>& progress);

}  // namespace biopsy::fault_injection
