// Many rehearsals of a case with faults, each with another seed, on all cores.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "robot/procedure/campaign/fault_grid.hpp"
#include "robot/procedure/rehearsal.hpp"

namespace biopsy::robot {

inline constexpr double kBeyondMost_mm = 2.0;  // no fault may take the needle further beyond the target

// What became of the runs of one entry.
struct EntryResult {
  std::string name;
  int runs = 0;
  int began = 0;                           // a fault of Motion does not begin where the run stops before
  int completed = 0;                       // the depth checks accepted every step
  int beyond = 0;                          // true depth more than kBeyondMost_mm beyond the target
  double worst_mm = 0.0;                   // deepest true depth less the target's
  double completed_off_mm = 0.0;           // largest |true depth - target| of a completed run
  std::uint64_t worst_seed = 0;            // for `dry-run --seed`
  double worst_from_depth_mm = 0.0;        // where its fault began; 0: at the start
  std::map<std::string, int> detected_by;  // runs by the hazard, or "depth check", that named it first
  double detected_ms_median = report::kUnknown, detected_ms_max = report::kUnknown;

  // Upper end of the one-sided 95 % interval (Clopper and Pearson) of the share of runs beyond.
  double beyond_upper95() const;
};

struct CampaignOptions {
  int runs = 20;  // of each entry, with seeds from `seed`
  std::uint64_t seed = 1;
  std::stop_token stop = {};
};

// Confirmation images lie in folders below `scratch` while they are needed. Ends early where a stop is
// requested: entries then hold what was run. `prepared` must hold a plan. The result depends on seeds only.
std::vector<EntryResult> run_campaign(const PreparedCase& prepared, const std::vector<FaultEntry>& entries,
                                      const CampaignOptions& options, const std::filesystem::path& scratch,
                                      const Progress& progress);

}  // namespace biopsy::robot
