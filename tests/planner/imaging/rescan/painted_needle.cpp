#include "tests/planner/imaging/rescan/painted_needle.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace biopsy::imaging::rescan {
namespace {

double inside(double depth_mm, double soft_mm) {
  return 0.5 * std::erfc(-depth_mm / (std::sqrt(2.0) * soft_mm));
}

struct Effect {
  double lost = 0.0, added = 0.0;
};

Effect effect_at(const PaintedNeedle& needle, const Direction& side, const Point& p_S) {
  const Eigen::Vector3d d = p_S - needle.p_SE;
  const double t = d.dot(needle.axis_S);
  const Eigen::Vector3d across = d - t * needle.axis_S;
  const double from_axis = across.norm(), end = needle.tip_mm + needle.beyond_mm;
  const double rim = std::min(from_axis / needle.radius_mm, 1.0);
  const double rounded_end = end - needle.roundness * needle.radius_mm * (1.0 - std::sqrt(1.0 - rim * rim));
  const double in_length =
      inside(rounded_end - t, needle.soft_mm) * inside(t + needle.behind_mm, needle.soft_mm);
  Effect effect;
  effect.lost = inside(needle.radius_mm - from_axis, needle.soft_mm) * in_length;
  if (needle.bulb > 0.0) {
    const double ball = needle.radius_mm * (1.0 + needle.bulb);
    const Point centre = needle.p_SE + (end - ball) * needle.axis_S;
    effect.lost = std::max(effect.lost, inside(ball - (p_S - centre).norm(), needle.soft_mm));
  }
  effect.lost *= needle.loss;
  const double beside = (across - 1.6 * needle.radius_mm * side).norm();
  effect.added = needle.pile_up * inside(0.6 * needle.radius_mm - beside, needle.soft_mm) * in_length;
  return effect;
}

std::vector<Eigen::Vector3d> parts_of_voxel(const Grid& grid) {
  const Eigen::Vector3i count = (grid.spacing_mm() / 0.3).array().ceil().max(1.0).min(8.0).cast<int>();
  std::vector<Eigen::Vector3d> parts;
  for (int k = 0; k < count.z(); ++k)
    for (int j = 0; j < count.y(); ++j)
      for (int i = 0; i < count.x(); ++i)
        parts.push_back(
            grid.X_SI.linear() *
            ((Eigen::Vector3d(i, j, k).array() + 0.5) / count.cast<double>().array() - 0.5).matrix());
  return parts;
}

}  // namespace

Volume painted(const Volume& scan, const PaintedNeedle& needle, double floor) {
  Volume result = scan;
  const std::vector<Eigen::Vector3d> parts = parts_of_voxel(scan.grid);
  const Direction side = needle.axis_S.unitOrthogonal();
  const double reach = 2.5 * needle.radius_mm + 4.0 * needle.soft_mm + scan.grid.spacing_mm().norm();
  for (int k = 0; k < scan.grid.size.z(); ++k)
    for (int j = 0; j < scan.grid.size.y(); ++j)
      for (int i = 0; i < scan.grid.size.x(); ++i) {
        const Point p_S = scan.grid.X_SI * Eigen::Vector3d(i, j, k);
        const Eigen::Vector3d d = p_S - needle.p_SE;
        const double t = d.dot(needle.axis_S);
        const bool near = (d - t * needle.axis_S).norm() <= reach && t >= -needle.behind_mm - reach &&
                          t <= needle.tip_mm + needle.beyond_mm + reach;
        if (!near) continue;
        Effect mean;
        for (const Eigen::Vector3d& part : parts) {
          const Effect one = effect_at(needle, side, p_S + part);
          mean.lost += one.lost, mean.added += one.added;
        }
        const auto share = 1.0 / static_cast<double>(parts.size());
        float& value = result.voxels[scan.grid.index(i, j, k)];
        const double left =
            static_cast<double>(value) * std::max(1.0 - mean.lost * share + mean.added * share, 0.0);
        value = static_cast<float>(std::hypot(left, floor));
      }
  return result;
}

}  // namespace biopsy::imaging::rescan
