#include "drivers/commissioning/sample_figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "robot/common/statistics.hpp"
#include "robot/common/units.hpp"

namespace biopsy::commissioning {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kPeriod_us = std::chrono::microseconds(kTick).count();

std::vector<double> values_of(std::span<const Sample> samples, Quantity quantity) {
  std::vector<double> values;
  for (const Sample& sample : samples) values.push_back(quantity(sample));
  return values;
}

}  // namespace

double mean(std::span<const Sample> samples, Quantity quantity) {
  return biopsy::mean(values_of(samples, quantity));
}

double deviation(std::span<const Sample> samples, Quantity quantity) {
  return standard_deviation(values_of(samples, quantity));
}

double share(std::span<const Sample> samples, const std::function<bool(const Sample&)>& is) {
  const auto count = std::count_if(samples.begin(), samples.end(), is);
  return samples.empty() ? kNone : static_cast<double>(count) / static_cast<double>(samples.size());
}

double fewest_codes(std::span<const Sample> samples, std::size_t window) {
  if (samples.size() < window) return kNone;
  std::size_t fewest = window;
  for (std::size_t first = 0; first + window <= samples.size(); first += window) {
    std::set<std::int32_t> codes;
    for (const Sample& sample : samples.subspan(first, window)) codes.insert(sample.reading.laser_code);
    fewest = std::min(fewest, codes.size());
  }
  return static_cast<double>(fewest);
}

bool missed_its_period(const Sample& sample) {
  return sample.late_us + sample.work_us > kPeriod_us;
}

double most_missed(std::span<const Sample> samples, std::size_t window) {
  int most = 0, now = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    now += missed_its_period(samples[k]) ? 1 : 0;
    if (k >= window) now -= missed_its_period(samples[k - window]) ? 1 : 0;
    most = std::max(most, now);
  }
  return samples.empty() ? kNone : most;
}

double longest_gap_ms(std::span<const Sample> samples) {
  if (samples.size() < 2) return kNone;
  std::int64_t longest_us = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const std::int64_t gap_us = samples[k].reading.time_us - samples[k - 1].reading.time_us;
    if (gap_us <= 0) return kNone;  // no clock
    longest_us = std::max(longest_us, gap_us);
  }
  return static_cast<double>(longest_us) * 1e-3;
}

Line line_through(const std::vector<double>& x, const std::vector<double>& y) {
  const auto count = static_cast<double>(x.size());
  double sum_x = 0.0, sum_y = 0.0, sum_xx = 0.0, sum_xy = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k)
    sum_x += x[k], sum_y += y[k], sum_xx += x[k] * x[k], sum_xy += x[k] * y[k];
  const double gain = (count * sum_xy - sum_x * sum_y) / (count * sum_xx - sum_x * sum_x);
  const double offset = (sum_y - gain * sum_x) / count;
  double largest = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k)
    largest = std::max(largest, std::abs(y[k] - offset - gain * x[k]));
  return {gain, offset, largest};
}

}  // namespace biopsy::commissioning
