// Many rehearsals of a case with faults, each with another seed, on all cores.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "robot/procedure/campaign/campaign_runs.hpp"
#include "robot/procedure/campaign/fault_grid.hpp"
#include "robot/procedure/rehearsal.hpp"

namespace biopsy::robot {

struct CampaignOptions {
  int runs = 20;  // of each entry, with seeds from `seed`
  std::uint64_t seed = 1;
  Shard shard = {};
  std::stop_token stop = {};
};

// The rehearsals of the shard. Confirmation images lie in folders below `scratch` while they are needed. Ends
// early where a stop is requested: what was not run is not done. `prepared` must hold a plan. The result
// depends on seeds only.
CampaignRuns run_campaign(const PreparedCase& prepared, const std::vector<FaultEntry>& entries,
                          const CampaignOptions& options, const std::filesystem::path& scratch,
                          const Progress& progress);

}  // namespace biopsy::robot
