#include "sim/scanner/phantom.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robot/common/config_error.hpp"
#include "sim/plant/seeded_noise.hpp"

namespace biopsy::sim {
namespace {

double smooth_step(double f) {
  return f * f * (3.0 - 2.0 * f);
}

// Random values on a lattice, blended smoothly between: texture that looks alike in all directions, -1 to 1.
double texture(const Eigen::Vector3d& place, double cell_mm, std::uint64_t seed) {
  const Eigen::Vector3d scaled = place / cell_mm + Eigen::Vector3d::Constant(1000.0);
  const Eigen::Vector3d low = scaled.array().floor();
  double sum = 0.0;
  for (int n = 0; n < 8; ++n) {
    double weight = 1.0;
    std::uint64_t counter = 0;
    for (int a = 0; a < 3; ++a) {
      const int up = (n >> a) & 1;
      const double f = smooth_step(scaled[a] - low[a]);
      weight *= up ? f : 1.0 - f;
      counter = counter * 4096u + static_cast<std::uint64_t>(low[a] + up);
    }
    sum += weight * (2.0 * uniform(seed, counter) - 1.0);
  }
  return sum;
}

// A tube through the block, for liver vessels: 1 inside, 0 outside.
double tube(const Eigen::Vector3d& place, const Point& through, const Direction& along, double radius_mm) {
  const Eigen::Vector3d d = place - through;
  const double distance = (d - d.dot(along) * along).norm();
  return std::clamp(0.5 + (radius_mm - distance) / 0.5, 0.0, 1.0);
}

// Signal at a place in the needle's own axes (z along the insertion from the entry, mm). Means after T2
// weighting: gel 700, muscle 300, saline 900, liver 450, vessels 800.
double signal(const Eigen::Vector3d& place, const PhantomSettings& s) {
  const double soft = s.voxel.value;  // a border inside a voxel is a mixture
  const auto beyond = [&](double depth) { return std::clamp(0.5 + (place.z() - depth) / soft, 0.0, 1.0); };
  const double coarse = texture(place, 4.0, s.seed), fine = texture(place, 1.5, s.seed + 1);
  const double fibres = std::sin(2.0 * std::numbers::pi * (place.x() + 0.4 * place.y()) / 3.1);
  const double pad = 700.0 * (1.0 + 0.12 * coarse);
  const double muscle = 300.0 * (1.0 + 0.15 * fibres + 0.15 * fine);
  const double gap = 900.0 * (1.0 + 0.05 * fine);
  double liver = 450.0 * (1.0 + 0.15 * coarse + 0.15 * fine);
  const double vessels =
      std::max({tube(place, {5.0, 0.0, 9.0}, Direction(0.1, 1.0, 0.2).normalized(), 1.2),
                tube(place, {-6.0, 4.0, 12.0}, Direction(1.0, -0.7, 0.3).normalized(), 1.6),
                tube(place, {3.0, -7.0, 16.0}, Direction(0.2, 0.3, 1.0).normalized(), 1.0)});
  liver += vessels * (800.0 - liver);
  double value = pad * beyond(-s.pad.value);  // air before the pad
  value += beyond(0.0) * (muscle - value);
  value += beyond(s.muscle.value) * (gap - value);
  return value + beyond(s.muscle.value + s.gap.value) * (liver - value);
}

float label(double depth, const PhantomSettings& s) {
  if (depth < 0.0) return 0.0f;
  if (depth < s.muscle.value) return 1.0f;
  return depth < s.muscle.value + s.gap.value ? 2.0f : 3.0f;
}

Grid oblique_grid(const PhantomSettings& s) {
  Grid grid;
  grid.size = (s.size_mm / s.voxel.value).array().round().cast<int>();
  const Eigen::Matrix3d tilt =
      Eigen::AngleAxisd(35.0 * std::numbers::pi / 180.0, Direction(0.3, 1.0, -0.5).normalized())
          .toRotationMatrix();
  grid.X_SI.linear() = tilt * s.voxel.value;
  const Point centre_S(12.0, -31.0, 48.0);
  grid.X_SI.translation() =
      centre_S - grid.X_SI.linear() * (0.5 * (grid.size.cast<double>().array() - 1.0)).matrix();
  return grid;
}

}  // namespace

Phantom paper_phantom(const PhantomSettings& settings) {
  const bool sizes = settings.voxel.value > 0.0 && settings.size_mm.minCoeff() >= 3.0 * settings.voxel.value;
  if (!sizes || settings.size_mm.prod() / std::pow(settings.voxel.value, 3) > 2e8)
    throw ConfigError("the block has no voxels or too many", "paper phantom",
                      "choose a voxel and a size in mm above 0");
  Phantom phantom;
  phantom.image.grid = oblique_grid(settings);
  phantom.image.format = "phantom";
  phantom.image.identity.patient_id = "PHANTOM";
  phantom.image.identity.description = "muscle, gap, liver";
  phantom.labels = phantom.image;

  const Eigen::Matrix3d block = phantom.image.grid.X_SI.linear() / settings.voxel.value;
  const double lean = 15.0 * std::numbers::pi / 180.0;
  phantom.axis_S = block * Direction(std::cos(lean), std::sin(lean) * 0.8, std::sin(lean) * 0.6);
  const Eigen::Vector3d entry(0.3 * settings.size_mm.x(), 0.4 * settings.size_mm.y(),
                              0.5 * settings.size_mm.z());
  phantom.p_SE = phantom.image.grid.X_SI * (entry / settings.voxel.value);
  const Direction side = block.col(2).cross(phantom.axis_S).normalized();
  const Direction up = phantom.axis_S.cross(side);

  const Grid& grid = phantom.image.grid;
  phantom.image.voxels.reserve(grid.voxel_count());
  phantom.labels.voxels.reserve(grid.voxel_count());
  for (int k = 0; k < grid.size.z(); ++k)
    for (int j = 0; j < grid.size.y(); ++j)
      for (int i = 0; i < grid.size.x(); ++i) {
        const Eigen::Vector3d d = grid.X_SI * Eigen::Vector3d(i, j, k) - phantom.p_SE;
        const Eigen::Vector3d place(d.dot(side), d.dot(up), d.dot(phantom.axis_S));
        phantom.image.voxels.push_back(static_cast<float>(signal(place, settings)));
        phantom.labels.voxels.push_back(label(place.z(), settings));
      }
  return phantom;
}

}  // namespace biopsy::sim
