// Statistics of samples in memory. Sums run from the first value to the last, so that results are the same
// on every machine. All return NaN where there are too few values.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace biopsy {

// Standard deviation of a normal distribution over its median absolute deviation: 1 / inverse_Phi(3/4).
inline constexpr double kMadToSigma = 1.4826;
// Half the width of a 95 % interval, in standard deviations of a normal distribution.
inline constexpr double kTwoSided95 = 1.959963984540054;

inline double mean(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// Unbiased estimate of the variance (n - 1), then the square root; at least two values.
inline double standard_deviation(std::span<const double> values) {
  const double centre = mean(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - centre) * (value - centre);
  return values.size() < 2 ? std::numeric_limits<double>::quiet_NaN()
                           : std::sqrt(squares / static_cast<double>(values.size() - 1));
}

inline double rms(std::span<const double> values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

// The value of rank `rank`, from 0, among the sorted ones.
template <class Number>
Number order_statistic(std::vector<Number> values, std::size_t rank) {
  if (values.empty()) return std::numeric_limits<Number>::quiet_NaN();
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::min(rank, values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The value of the sample that `share` of the others, in [0, 1], do not exceed: rank share (n - 1), rounded
// down; no interpolation.
template <class Number>
Number quantile(std::vector<Number> values, double share) {
  const std::size_t last = values.empty() ? 0 : values.size() - 1;
  return order_statistic(std::move(values), static_cast<std::size_t>(share * static_cast<double>(last)));
}

// Of an even number of values the upper one of the two in the middle.
template <class Number>
Number median(std::vector<Number> values) {
  const std::size_t middle = values.size() / 2;
  return order_statistic(std::move(values), middle);
}

}  // namespace biopsy
