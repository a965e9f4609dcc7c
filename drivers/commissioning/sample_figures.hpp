// Statistics of samples, in mm, kV, mA and us.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "drivers/commissioning/rig.hpp"

namespace biopsy::commissioning {

using Quantity = double (*)(const Sample&);

inline double depth_mm(const Sample& sample) {
  return sample.reading.depth_um * 1e-3;
}
inline double monitor_kV(const Sample& sample) {
  return sample.reading.monitor_mV * 1e-6;
}
inline double command_kV(const Sample& sample) {
  return sample.command_mV * 1e-6;
}
inline double milliamperes(const Sample& sample) {
  return sample.reading.current_nA * 1e-6;
}

// NaN where there are no samples.
double mean(std::span<const Sample> samples, Quantity quantity);
double deviation(std::span<const Sample> samples, Quantity quantity);  // one standard deviation
double share(std::span<const Sample> samples, const std::function<bool(const Sample&)>& is);

// Smallest number of different laser codes in consecutive windows of `window` samples.
double fewest_codes(std::span<const Sample> samples, std::size_t window);

// 1 kHz
bool missed_its_period(const Sample& sample);
double most_missed(std::span<const Sample> samples, std::size_t window);
double longest_gap_ms(std::span<const Sample> samples);  // between two readings, on the stage's clock

// Straight line through (x, y): least squares.
struct Line {
  double gain, offset, largest_residual;
};
Line line_through(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace biopsy::commissioning
