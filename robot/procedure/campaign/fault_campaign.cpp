#include "robot/procedure/campaign/fault_campaign.hpp"

#include <fmt/format.h>

#include <atomic>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>

#include "robot/common/in_parallel.hpp"
#include "robot/common/statistics.hpp"
#include "sim/plant/seeded_noise.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

constexpr double kConfidence = 0.95;
// A fault in motion begins in this part of the way to the target.
constexpr double kFirstBegin = 0.05, kLastBegin = 0.95;

struct RunResult {
  bool done = false, began = false, completed = false;
  double beyond_mm = 0.0, from_depth_mm = 0.0;
  std::string detected_by;
  double detected_after_ms = report::kUnknown;
};

RunResult run_one(const PreparedCase& prepared, const FaultEntry& entry, std::uint64_t seed,
                  const fs::path& folder, const std::stop_token& stop) {
  const double target_mm = std::get<Plan>(prepared.plan).target_depth.value;
  RunResult result;
  std::vector<sim::Fault> faults = entry.faults;
  if (entry.begin == FaultBegin::Motion) {
    const double share = sim::uniform(sim::hashed(seed, 0x626567696e), 0);
    result.from_depth_mm = target_mm * (kFirstBegin + share * (kLastBegin - kFirstBegin));
    for (sim::Fault& fault : faults)
      if (!fault.from_s && !fault.from_depth_mm) fault.from_depth_mm = result.from_depth_mm;
  }
  PreparedCase own = prepared;
  own.given.seed = seed;
  const report::RunRecord record = rehearse(
      own, folder, [](double, const std::string&) {}, stop, faults);
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  result.done = !stop.stop_requested();
  result.completed = record.outcome == report::Outcome::Completed;
  result.beyond_mm = record.true_depth_max_mm - target_mm;
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

EntryResult sum_of(const FaultEntry& entry, const std::vector<RunResult>& runs, std::uint64_t first_seed) {
  EntryResult sum;
  sum.name = entry.name;
  std::vector<double> after_ms;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const RunResult& run = runs[i];
    if (!run.done) continue;
    ++sum.runs;
    sum.began += run.began;
    sum.completed += run.completed;
    sum.beyond += run.beyond_mm > kBeyondMost_mm;
    if (run.completed) sum.completed_off_mm = std::max(sum.completed_off_mm, std::abs(run.beyond_mm));
    if (sum.runs == 1 || run.beyond_mm > sum.worst_mm) {
      sum.worst_mm = run.beyond_mm;
      sum.worst_seed = first_seed + i;
      sum.worst_from_depth_mm = run.from_depth_mm;
    }
    if (run.detected_by.empty()) continue;
    ++sum.detected_by[run.detected_by];
    after_ms.push_back(run.detected_after_ms);
  }
  if (!after_ms.empty()) {
    sum.detected_ms_median = median(after_ms);
    sum.detected_ms_max = *std::max_element(after_ms.begin(), after_ms.end());
  }
  return sum;
}

}  // namespace

double EntryResult::beyond_upper95() const {
  if (runs == 0) return 1.0;
  return boost::math::binomial_distribution<>::find_upper_bound_on_p(runs, beyond, 1.0 - kConfidence);
}

std::vector<EntryResult> run_campaign(const PreparedCase& prepared, const std::vector<FaultEntry>& entries,
                                      const CampaignOptions& options, const fs::path& scratch,
                                      const Progress& progress) {
  const auto runs = static_cast<std::size_t>(options.runs);
  std::vector<std::vector<RunResult>> results(entries.size(), std::vector<RunResult>(runs));
  std::atomic<std::size_t> done = 0;
  const std::size_t count = entries.size() * runs;
  in_parallel(count, [&](std::size_t i) {
    if (options.stop.stop_requested()) return;
    const FaultEntry& entry = entries[i / runs];
    results[i / runs][i % runs] =
        run_one(prepared, entry, options.seed + i % runs, scratch / fmt::format("run-{}", i), options.stop);
    const std::size_t now = ++done;
    progress(static_cast<double>(now) / static_cast<double>(count),
             fmt::format("rehearsal {} of {}: {}", now, count, entry.name));
  });
  std::vector<EntryResult> sums;
  for (std::size_t e = 0; e < entries.size(); ++e)
    sums.push_back(sum_of(entries[e], results[e], options.seed));
  return sums;
}

}  // namespace biopsy::robot
