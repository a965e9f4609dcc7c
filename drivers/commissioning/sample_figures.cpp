#include "drivers/commissioning/sample_figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "robot/common/units.hpp"

namespace biopsy::commissioning {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kPeriod_us = std::chrono::microseconds(kTick).count();

}  // namespace

double mean(std::span<const Sample> samples, Quantity quantity) {
  double sum = 0.0;
  for (const Sample& sample : samples) sum += quantity(sample);
  return samples.empty() ? kNone : sum / static_cast<double>(samples.size());
}

double deviation(std::span<const Sample> samples, Quantity quantity) {
  if (samples.size() < 2) return kNone;
  const double middle = mean(samples, quantity);
  double squares = 0.0;
  for (const Sample& sample : samples) squares += std::pow(quantity(sample) - middle, 2);
  return std::sqrt(squares / static_cast<double>(samples.size() - 1));
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

double percentile(std::vector<double> values, double share_below) {
  if (values.empty()) return kNone;
  const auto rank = static_cast<std::size_t>(share_below * static_cast<double>(values.size() - 1));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
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
