#include "sim/scanner/scanner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "robot/common/config_error.hpp"
#include "robot/common/statistics.hpp"
#include "sim/plant/seeded_noise.hpp"
#include "sim/scanner/susceptibility/needle_image.hpp"

namespace biopsy::sim {
namespace {

// Catmull-Rom weights of the four neighbours of a point that lies f beyond the second.
std::array<double, 4> cubic_weights(double f) {
  const double f2 = f * f, f3 = f2 * f;
  return {-0.5 * f3 + f2 - 0.5 * f, 1.5 * f3 - 2.5 * f2 + 1.0, -1.5 * f3 + 2.0 * f2 + 0.5 * f,
          0.5 * f3 - 0.5 * f2};
}

// Tissue at a voxel index of the planning volume; air beyond half a voxel outside.
double tissue_at(const Volume& planning, const Eigen::Vector3d& index) {
  std::array<double, 4> w[3];
  int n[3][4];
  for (int a = 0; a < 3; ++a) {
    const int size = planning.grid.size[a];
    if (!(index[a] >= -0.5 && index[a] <= size - 0.5)) return 0.0;
    const double floor = std::floor(index[a]);
    w[a] = cubic_weights(index[a] - floor);
    for (int m = 0; m < 4; ++m) n[a][m] = std::clamp(static_cast<int>(floor) - 1 + m, 0, size - 1);
  }
  double sum = 0.0;
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j) {
      const std::size_t row = planning.grid.index(0, n[1][j], n[2][k]);
      double line = 0.0;
      for (int i = 0; i < 4; ++i)
        line += w[0][i] * static_cast<double>(planning.voxels[row + static_cast<std::size_t>(n[0][i])]);
      sum += w[2][k] * w[1][j] * line;
    }
  return std::max(sum, 0.0);
}

// Places within a box about the origin, no further apart than `step`, whose mean stands for the mean over the
// box.
std::vector<Eigen::Vector3d> places_in_box(const Eigen::Matrix3d& axes, const Eigen::Vector3d& sides,
                                           double step) {
  Eigen::Vector3i count;
  for (int a = 0; a < 3; ++a) count[a] = std::clamp(static_cast<int>(std::ceil(sides[a] / step)), 1, 12);
  std::vector<Eigen::Vector3d> places;
  for (int k = 0; k < count.z(); ++k)
    for (int j = 0; j < count.y(); ++j)
      for (int i = 0; i < count.x(); ++i) {
        const Eigen::Vector3d fraction =
            (Eigen::Vector3d(i, j, k).array() + 0.5) / count.cast<double>().array() - 0.5;
        places.push_back(axes * fraction.cwiseProduct(sides));
      }
  return places;
}

// Smooth change of sensitivity: a random plane plus a random saddle over the volume, +-1 at most.
struct Drift {
  double amount;
  Eigen::Vector3d slope;
  double saddle;

  Drift(double fraction, std::uint64_t seed) : amount(fraction), saddle(2.0 * uniform(seed, 103) - 1.0) {
    for (int a = 0; a < 3; ++a) slope[a] = 2.0 * uniform(seed, 100U + static_cast<std::uint64_t>(a)) - 1.0;
  }
  double at(const Eigen::Vector3d& place) const {  // place: -1 to 1 over the volume
    return 1.0 + amount * (slope.dot(place) + saddle * place.x() * place.y()) / 4.0;
  }
};

double voids_left(const std::vector<TissueVoid>& voids, const Point& p_before) {
  double left = 1.0;
  for (const TissueVoid& trace : voids) left *= signal_left(trace, p_before);
  return left;
}

double needle_left(const NeedleArtefact& needle, const Point& centre, double half_diagonal,
                   const std::vector<Eigen::Vector3d>& places) {
  const Eigen::Vector3d d = centre - needle.p_SE;
  const Direction axis = needle.axis_S.normalized();
  const double along = d.dot(axis);
  const double reach =
      half_diagonal + needle.radius.value * (1.0 + needle.tip_bloom) + 4.0 * needle.edge.value;
  if ((d - along * axis).norm() > reach || along > needle.tip_depth.value + reach) return 1.0;
  double sum = 0.0;
  for (const Eigen::Vector3d& place : places) sum += signal_left(needle, centre + place);
  return sum / static_cast<double>(places.size());
}

// Along the phase axis: 0 for i, 1 for j.
void add_ghost(Volume& image, double fraction, int shift, int axis) {
  const std::vector<float> clean = image.voxels;
  const int lines = image.grid.size[axis];
  for (int k = 0; k < image.grid.size.z(); ++k)
    for (int j = 0; j < image.grid.size.y(); ++j)
      for (int i = 0; i < image.grid.size.x(); ++i) {
        Eigen::Vector3i from(i, j, k);
        from[axis] = ((from[axis] - shift) % lines + lines) % lines;  // aliases around the field of view
        image.voxels[image.grid.index(i, j, k)] +=
            static_cast<float>(fraction) * clean[image.grid.index(from.x(), from.y(), k)];
      }
}

void add_noise(Volume& image, double sigma, std::uint64_t seed) {
  for (std::size_t n = 0; n < image.voxels.size(); ++n) {
    const NormalPair noise = normals(seed, n);
    const double real = static_cast<double>(image.voxels[n]) + sigma * noise.first;
    image.voxels[n] = static_cast<float>(std::hypot(real, sigma * noise.second));
  }
}

void refuse_bad(const Volume& planning, const ScanSettings& settings, const Grid& grid) {
  if (settings.needle && settings.body)
    throw ConfigError("a painted needle and a needle with a field", "simulated scanner", "keep one of them");
  refuse_bad_sequence(settings.sequence, "simulated scanner");
  const bool numbers = settings.motion.shift_mm.allFinite() && settings.motion.rotation_deg.allFinite() &&
                       settings.motion.about.allFinite() && std::isfinite(settings.snr) &&
                       std::isfinite(settings.drift) && std::isfinite(settings.ghost);
  if (numbers && planning.grid.voxel_count() > 0 && planning.voxels.size() == planning.grid.voxel_count() &&
      grid.size.minCoeff() > 0 && std::abs(grid.X_SI.linear().determinant()) > 0.0)
    return;
  throw ConfigError("a grid is empty or a number is not finite", "simulated scanner",
                    "give a planning volume with voxels and finite settings");
}

}  // namespace

RigidTransform PatientMotion::X_after_before() const {
  const Eigen::Vector3d rotation = rotation_deg * (std::numbers::pi / 180.0);
  const double angle = rotation.norm();
  RigidTransform X = RigidTransform::Identity();
  if (angle > 0.0) X.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  X.translation() = about + shift_mm - X.linear() * about;
  return X;
}

double tissue_signal(const Volume& volume) {
  std::vector<float> values = volume.voxels;
  if (values.empty()) return 0.0;
  const float air = 0.1f * quantile(values, 0.99);
  values.erase(std::remove_if(values.begin(), values.end(), [&](float x) { return x <= air; }), values.end());
  if (values.empty()) return 0.0;
  return static_cast<double>(median(std::move(values)));
}

Volume scan(const Volume& planning, const ScanSettings& settings) {
  Volume image;
  image.grid = settings.grid.value_or(planning.grid);
  refuse_bad(planning, settings, image.grid);
  image.identity = planning.identity;
  image.format = "phantom";
  image.voxels.resize(image.grid.voxel_count());

  const RigidTransform X_before_after = settings.motion.X_after_before().inverse();
  const AffineTransform X_IS = planning.grid.X_SI.inverse();
  const Eigen::Vector3d spacing = image.grid.spacing_mm();
  const Eigen::Matrix3d axes = image.grid.X_SI.linear() * spacing.cwiseInverse().asDiagonal();
  const auto voxel = places_in_box(axes, spacing, 0.3);
  // Planning voxels are means already: only what the new voxel is larger must still be averaged.
  const auto tissue = places_in_box(axes, (spacing - planning.grid.spacing_mm()).cwiseMax(0.0), 0.5);
  const Drift drift(settings.drift, settings.seed);
  const Eigen::Vector3d half = 0.5 * (image.grid.size.cast<double>().array() - 1.0).max(1.0);

  for (int k = 0; k < image.grid.size.z(); ++k)
    for (int j = 0; j < image.grid.size.y(); ++j)
      for (int i = 0; i < image.grid.size.x(); ++i) {
        const Eigen::Vector3d index(i, j, k);
        const Point p_S = image.grid.X_SI * index;
        double value = 0.0;
        for (const Eigen::Vector3d& place : tissue) {
          const Point p_before = X_before_after * (p_S + place);
          value += tissue_at(planning, X_IS * p_before) * voids_left(settings.voids, p_before);
        }
        value *= drift.at((index - half).cwiseQuotient(half)) / static_cast<double>(tissue.size());
        if (settings.needle) value *= needle_left(*settings.needle, p_S, 0.5 * spacing.norm(), voxel);
        image.voxels[image.grid.index(i, j, k)] = static_cast<float>(value);
      }
  if (settings.body) image = image_with_needle(image, *settings.body, settings.sequence);
  if (settings.ghost > 0.0)
    add_ghost(image, settings.ghost, settings.ghost_shift_voxels, 1 - settings.sequence.read_axis);
  if (settings.snr > 0.0) add_noise(image, tissue_signal(planning) / settings.snr, settings.seed);
  return image;
}

}  // namespace biopsy::sim
