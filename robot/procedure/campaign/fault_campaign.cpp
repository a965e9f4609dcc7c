#include "robot/procedure/campaign/fault_campaign.hpp"

#include <fmt/format.h>

#include <atomic>
#include <cmath>

#include "robot/common/in_parallel.hpp"
#include "sim/plant/seeded_noise.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

// A fault in motion begins in this part of the way to the target.
constexpr double kFirstBegin = 0.05, kLastBegin = 0.95;

CampaignRun run_one(const PreparedCase& prepared, const FaultEntry& entry, std::uint64_t seed,
                    const fs::path& folder, const std::stop_token& stop) {
  const double target_mm = std::get<Plan>(prepared.plan).target_depth.value;
  CampaignRun result;
  std::vector<sim::Fault> faults = entry.faults;
  if (entry.begin == FaultBegin::Motion) {
    const double share = sim::uniform(sim::hashed(seed, 0x626567696e), 0);
    result.from_depth_mm = target_mm * (kFirstBegin + share * (kLastBegin - kFirstBegin));
    for (sim::Fault& fault : faults)
      if (!fault.from_s && !fault.from_depth_mm) fault.from_depth_mm = result.from_depth_mm;
  }
  for (const sim::Fault& fault : faults)
    if (fault.from_depth_mm) result.from_depth_mm = *fault.from_depth_mm;
  PreparedCase own = prepared;
  own.given.seed = seed;
  const report::RunRecord record = rehearse(
      own, folder, [](double, const std::string&) {}, stop, faults);
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  result.done = !stop.stop_requested();
  result.completed = record.outcome == report::Outcome::Completed;
  result.beyond_mm = record.true_depth_max_mm - target_mm;
  if (std::isfinite(record.true_final_depth_mm)) result.off_mm = record.true_final_depth_mm - target_mm;
  for (const report::FaultResult& fault : record.faults) {
    if (std::isnan(fault.began_s)) continue;
    result.began = true;
    const bool sooner =
        std::isnan(result.detected_after_ms) || fault.detected_after_ms < result.detected_after_ms;
    if (!fault.detected_by.empty() && sooner) {
      result.detected_by = fault.detected_by;
      result.detected_after_ms = fault.detected_after_ms;
    }
  }
  return result;
}

}  // namespace

CampaignRuns run_campaign(const PreparedCase& prepared, const std::vector<FaultEntry>& entries,
                          const CampaignOptions& options, const fs::path& scratch, const Progress& progress) {
  CampaignRuns out;
  out.target_mm = std::get<Plan>(prepared.plan).target_depth.value;
  out.seed = options.seed;
  out.images_accepted = prepared.given.rehearsal.accept_unseen;
  out.each = static_cast<std::size_t>(options.runs);
  for (const FaultEntry& entry : entries) out.names.push_back(entry.name);
  out.runs.resize(entries.size() * out.each);
  std::vector<std::size_t> jobs;
  for (std::size_t i = 0; i < out.runs.size(); ++i)
    if (options.shard.has(i)) jobs.push_back(i);
  std::atomic<std::size_t> done = 0;
  in_parallel(jobs.size(), [&](std::size_t job) {
    if (options.stop.stop_requested()) return;
    const std::size_t i = jobs[job];
    const FaultEntry& entry = entries[i / out.each];
    out.runs[i] = run_one(prepared, entry, options.seed + i % out.each, scratch / fmt::format("run-{}", i),
                          options.stop);
    const std::size_t now = ++done;
    progress(static_cast<double>(now) / static_cast<double>(jobs.size()),
             fmt::format("rehearsal {} of {}: {}", now, jobs.size(), entry.name));
  });
  return out;
}

}  // namespace biopsy::robot
