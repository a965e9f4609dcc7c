// What the rehearsals of a campaign gave, one by one; and parts of a campaign (shards) as files, from which
// the whole is merged. Numbers are written in digits that read back as the same number, so that a merged
// campaign equals one that ran at once, to the bit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::robot {

inline constexpr double kBeyondMost_mm = 2.0;  // no fault may take the needle further beyond the target
inline constexpr std::size_t kShardsMax = 100'000;

// The `index`-th of `count` parts: every count-th rehearsal. The default is the whole.
struct Shard {
  std::size_t index = 1, count = 1;

  bool has(std::size_t run) const { return run % count == index - 1; }
  bool operator==(const Shard&) const = default;
};
// "2/8". Throws ConfigError.
Shard parse_shard(const std::string& text);

struct CampaignRun {
  bool done = false;  // false: in another shard, or interrupted
  bool began = false, completed = false;
  double beyond_mm = 0.0, off_mm = 0.0;  // deepest, and last true depth, less the target's
  double from_depth_mm = 0.0;
  std::string detected_by = {};
  double detected_after_ms = report::kUnknown;
};

struct CampaignRuns {
  std::string identity;  // of program and inputs; equal in all shards of a campaign
  double target_mm = 0.0;
  std::uint64_t seed = 1;
  bool images_accepted = false;      // each unseen
  std::size_t each = 1;              // rehearsals of an entry, with seeds from `seed` up
  std::vector<std::string> names{};  // of the entries
  std::vector<CampaignRun> runs{};   // of entry e with seed + i at e * each + i
};

// What became of the runs of one entry.
struct EntryResult {
  std::string name;
  int runs = 0;
  int began = 0;                           // a fault of Motion does not begin where the run stops before
  int completed = 0;                       // the depth checks accepted every step
  int beyond = 0;                          // true depth more than kBeyondMost_mm beyond the target
  double worst_mm = 0.0;                   // deepest true depth less the target's
  double completed_off_mm = 0.0;           // largest |last true depth - target| of a completed run
  std::uint64_t worst_seed = 0;            // for `dry-run --seed`
  double worst_from_depth_mm = 0.0;        // where its fault began; 0: at the start, or at a time
  std::map<std::string, int> detected_by;  // runs by the hazard, or "depth check", that named it first
  double detected_ms_median = report::kUnknown, detected_ms_max = report::kUnknown;

  // Upper end of the one-sided 95 % interval (Clopper and Pearson) of the share of runs beyond.
  double beyond_upper95() const;
};
std::vector<EntryResult> entry_results(const CampaignRuns& campaign);

// FOLDER/INDEX-of-COUNT.json
std::filesystem::path shard_file(const std::filesystem::path& folder, const Shard& shard);
// Whole or not at all. The runs of the shard must be done.
void write_shard(const std::filesystem::path& file, const CampaignRuns& campaign, const Shard& shard);
// Throws ConfigError for a file that is no such shard, whole and in range; other shards' runs are not done.
CampaignRuns read_shard(const std::filesystem::path& file, const Shard& shard);
// All `count` shards of a folder. Throws ConfigError where one is missing or belongs to another campaign.
CampaignRuns merge_shards(const std::filesystem::path& folder, std::size_t count);

}  // namespace biopsy::robot
