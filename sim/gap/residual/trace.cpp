#include "sim/gap/residual/trace.hpp"

#include <algorithm>
#include <cassert>

#include "sim/gap/millimetres.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kKilovolt = 1e-3;
constexpr std::size_t kKeptOfABucket = 4;  // least and largest, before and after

struct RowRange {
  std::size_t from = 0, to = 0;
};

void keep_extremes(std::vector<std::size_t>& kept, const double* residual, const RowRange& bucket) {
  const auto [least, largest] = std::minmax_element(residual + bucket.from, residual + bucket.to);
  kept.push_back(static_cast<std::size_t>(least - residual));
  kept.push_back(static_cast<std::size_t>(largest - residual));
}

// Rows to draw, in order.
std::vector<std::size_t> kept_rows(const double* before, const double* after, const RowRange& part) {
  std::vector<std::size_t> kept;
  const std::size_t rows = part.to - part.from;
  if (rows <= kMostTracePoints) {
    for (std::size_t i = part.from; i < part.to; ++i) kept.push_back(i);
    return kept;
  }
  const std::size_t buckets = (kMostTracePoints - 2) / kKeptOfABucket;
  kept = {part.from, part.to - 1};
  for (std::size_t b = 0; b < buckets; ++b) {
    const RowRange bucket{part.from + b * rows / buckets, part.from + (b + 1) * rows / buckets};
    keep_extremes(kept, before, bucket);
    keep_extremes(kept, after, bucket);
  }
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  return kept;
}

GapTrace trace_of(const EvidenceRun& run, const RowRange& part, const double* before, const double* after,
                  const std::uint8_t* regime, double input_scale) {
  GapTrace trace;
  trace.run = run.name;
  trace.held_out = part.from >= run.training_rows;
  for (const std::size_t i : kept_rows(before, after, part)) {
    const Row& row = run.rows[i];
    trace.time.push_back(row.time);
    trace.input.push_back(input_scale * row.input);
    trace.measured.push_back(kMm * row.measured);
    trace.before.push_back(kMm * (row.measured - before[i]));
    trace.after.push_back(kMm * (row.measured - after[i]));
    trace.regime.push_back(regime[i]);
  }
  return trace;
}

}  // namespace

std::vector<GapTrace> traces(const Evidence& evidence, const std::vector<double>& before,
                             const std::vector<double>& after, const MainRegimes& regimes, Drive drive) {
  assert(before.size() == after.size() && before.size() == regimes.of_row.size());
  const double input_scale = drive == Drive::Force ? 1.0 : kKilovolt;
  std::vector<GapTrace> out;
  std::size_t first = 0;
  for (const EvidenceRun& run : evidence.runs) {
    for (const RowRange& part :
         {RowRange{0, run.training_rows}, RowRange{run.training_rows, run.rows.size()}})
      if (part.from < part.to)
        out.push_back(
            trace_of(run, part, &before[first], &after[first], &regimes.of_row[first], input_scale));
    first += run.rows.size();
  }
  return out;
}

}  // namespace biopsy::sim::gap
