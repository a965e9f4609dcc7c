#include "planner/imaging/registration/brightness.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace biopsy::imaging {
namespace {

double mean_of_known(const Volume& volume) {
  double total = 0.0;
  std::size_t count = 0;
  for (float value : volume.voxels)
    if (std::isfinite(value)) total += static_cast<double>(value), ++count;
  return total / static_cast<double>(std::max<std::size_t>(count, 1));
}

struct Scale {
  double sigma_mm;  // over which brightness may change, one standard deviation
  double little;    // share of tissue in that reach that tells next to nothing
};

// One scale: how much is left to explain between `after` and `before`.
BrightnessMap at_scale(const Volume& after, const Volume& before, const std::vector<bool>& used, double mean,
                       const Scale& scale) {
  // Local sums of 1, a, b, a b and b b.
  Volume one = after, a = after, b = after, ab = after, bb = after;
  for (std::size_t n = 0; n < used.size(); ++n) {
    const float x = used[n] ? before.voxels[n] : 0.0f, y = used[n] ? after.voxels[n] : 0.0f;
    one.voxels[n] = used[n] ? 1.0f : 0.0f;
    a.voxels[n] = y, b.voxels[n] = x, ab.voxels[n] = x * y, bb.voxels[n] = x * x;
  }
  for (Volume* sum : {&one, &a, &b, &ab, &bb}) *sum = smoothed(*sum, scale.sigma_mm);
  // Where tissue is all alike it tells a ratio, no slope.
  const double alike = std::pow(0.1 * mean, 2);
  BrightnessMap map{after, after};
  for (std::size_t n = 0; n < used.size(); ++n) {
    const double w = std::max(static_cast<double>(one.voxels[n]), 0.0);
    const double sum_a = std::max(static_cast<double>(a.voxels[n]), 0.0),
                 sum_b = std::max(static_cast<double>(b.voxels[n]), 0.0);
    const double ratio = std::clamp((sum_a + scale.little * mean) / (sum_b + scale.little * mean), 0.1, 10.0);
    double slope = ratio, offset = 0.0;
    if (w > scale.little) {
      const double mean_b = sum_b / w;
      const double covariance = static_cast<double>(ab.voxels[n]) / w - sum_a / w * mean_b,
                   variance = std::max(static_cast<double>(bb.voxels[n]) / w - mean_b * mean_b, 0.0);
      slope = std::clamp((covariance + alike * ratio) / (variance + alike), 0.3 * ratio, 1.5 * ratio);
      offset = (ratio - slope) * mean_b;
    }
    map.slope.voxels[n] = static_cast<float>(slope);
    map.offset.voxels[n] = static_cast<float>(offset);
  }
  return map;
}

}  // namespace

BrightnessMap learn_brightness(const Volume& after, const Volume& before, const NeedleMask& needle) {
  const double mean = mean_of_known(before);
  std::vector<bool> used(after.voxels.size());
  std::size_t n = 0;
  for (int k = 0; k < after.grid.size.z(); ++k)
    for (int j = 0; j < after.grid.size.y(); ++j)
      for (int i = 0; i < after.grid.size.x(); ++i, ++n)  // air's noise has a mean that is no brightness
        used[n] = static_cast<double>(before.voxels[n]) > 0.3 * mean &&
                  !needle.covers(after.grid.X_SI * Eigen::Vector3d(i, j, k));
  // Coils first; then what has an edge of its own, a saturation band or an organ with another contrast.
  BrightnessMap map = at_scale(after, before, used, mean, {.sigma_mm = 12.0, .little = 0.02});
  Volume matched = before;
  for (n = 0; n < used.size(); ++n)
    matched.voxels[n] = map.offset.voxels[n] + map.slope.voxels[n] * before.voxels[n];
  const BrightnessMap rest =
      at_scale(after, matched, used, mean_of_known(matched), {.sigma_mm = 5.0, .little = 0.05});
  for (n = 0; n < used.size(); ++n) {
    map.slope.voxels[n] *= rest.slope.voxels[n];
    map.offset.voxels[n] = rest.offset.voxels[n] + rest.slope.voxels[n] * map.offset.voxels[n];
  }
  return map;
}

}  // namespace biopsy::imaging
