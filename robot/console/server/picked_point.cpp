#include "robot/console/server/picked_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace biopsy::console {

std::variant<Point, std::string> picked_point(const Volume& image, const commands::SetPoint& picked) {
  if (picked.series_uid != image.identity.series_uid)
    return "the point is of another series than the one shown";
  const Eigen::Vector3d voxel(picked.voxel[0], picked.voxel[1], picked.voxel[2]);
  const Eigen::Vector3d last = image.grid.size.cast<double>().array() - 0.5;
  if (voxel.minCoeff() < -0.5 || (voxel.array() > last.array()).any())
    return "the point lies outside of the image";
  const Point p_S = image.grid.X_SI * voxel;
  const Point shown = lps_from_ras({picked.ras_mm[0], picked.ras_mm[1], picked.ras_mm[2]});
  const double apart_mm = (p_S - shown).norm();
  if (!(apart_mm <= kMismatchMax_mm))
    return fmt::format("the positions of page and server differ by {:.2f} mm", apart_mm);
  return p_S;
}

std::array<double, 16> ras_from_voxel(const Grid& grid) {
  Eigen::Matrix4d map = grid.X_SI.matrix();
  map.topRows<2>() *= -1.0;
  std::array<double, 16> rows{};
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(rows.data()) = map;
  return rows;
}

double oblique_deg(const Grid& grid) {
  double largest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = grid.X_SI.linear().col(axis).normalized().cwiseAbs().maxCoeff();
    largest = std::max(largest, std::acos(std::min(along, 1.0)) * 180.0 / std::numbers::pi);
  }
  return largest;
}

}  // namespace biopsy::console
