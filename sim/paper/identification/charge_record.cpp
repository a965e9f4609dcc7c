#include "sim/paper/identification/charge_record.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "robot/common/statistics.hpp"

namespace biopsy::sim::identification {
namespace {

constexpr double kStepShare = 0.02;  // of the largest voltage; less is noise of a measured voltage
constexpr double kSettling = 10e-3;  // s
constexpr double kGrowth = 0.1;      // length of a stretch over the time since the step

// Rows at whose beginning the voltage steps.
std::vector<bool> step_rows(const std::vector<double>& input) {
  double largest = 0.0;
  for (const double u : input) largest = std::max(largest, std::abs(u));
  std::vector<bool> steps(input.size());
  for (std::size_t m = 0; m < input.size(); ++m)
    steps[m] = std::abs(input[m] - (m > 0 ? input[m - 1] : 0.0)) > std::max(kStepShare * largest, 1e-9);
  return steps;
}

// One stretch over each step and its settling; the others grow with the time since it.
std::vector<Stretch> stretches(const std::vector<bool>& steps, std::size_t settling) {
  std::vector<Stretch> parts;
  std::size_t since = 0;  // where the last step had settled
  for (std::size_t from = 0; from < steps.size();) {
    std::size_t to = from;
    const auto length = static_cast<std::size_t>(kGrowth * static_cast<double>(from - since));
    const std::size_t grown = from + std::max<std::size_t>(1, length);
    while (to < std::min(grown, steps.size()) && !steps[to]) ++to;
    if (to == from) {  // a step, and steps that follow before it has settled
      std::size_t settled = from + settling;
      for (to = from; to < std::min(settled, steps.size()); ++to)
        if (steps[to]) settled = to + settling;
      since = to;
    }
    parts.push_back({from, to, 0.0});
    from = to;
  }
  return parts;
}

// From the median difference of neighbours, robust to jumps; at least the quantisation noise of the monitor.
double noise_of(const std::vector<double>& current, const std::vector<bool>& steps) {
  std::vector<double> differences;
  for (std::size_t m = 1; m < steps.size(); ++m)
    if (!steps[m] && !steps[m - 1]) differences.push_back(std::abs(current[m + 1] - current[m]));
  if (differences.empty()) return 0.0;
  double level = std::numeric_limits<double>::infinity();
  for (const double difference : differences)
    if (difference > 0.0) level = std::min(level, difference);
  const double rounded = std::isfinite(level) ? level / std::sqrt(12.0) : 0.0;
  // Of a normal distribution.
  return std::max(rounded, median(std::move(differences)) / (0.6745 * std::sqrt(2.0)));
}

}  // namespace

bool ChargeRecord::has_step(const Stretch& part) const {
  const std::vector<bool> at = step_rows(input);
  return std::any_of(at.begin() + static_cast<std::ptrdiff_t>(part.from),
                     at.begin() + static_cast<std::ptrdiff_t>(part.to), [](bool step) { return step; });
}

ChargeRecord charge_record(const RecordedRun& run) {
  assert(run.current.size() == run.time.size() && run.time.size() >= 2);
  ChargeRecord record;
  record.name = run.name;
  record.period = run.period;
  record.input.assign(run.input.begin(), run.input.end() - 1);
  const std::vector<bool> steps = step_rows(record.input);
  const auto settling = static_cast<std::size_t>(std::max(1.0, std::round(kSettling / run.period)));
  record.parts = stretches(steps, settling);
  for (Stretch& part : record.parts)
    for (std::size_t m = part.from; m < part.to; ++m) part.charge += run.current[m + 1] * run.period;
  record.steps = static_cast<std::size_t>(std::count(steps.begin(), steps.end(), true));
  const auto first = std::find(steps.begin(), steps.end(), true);
  record.after_step = static_cast<double>(steps.end() - first) * run.period;
  record.noise = noise_of(run.current, steps);
  return record;
}

}  // namespace biopsy::sim::identification
