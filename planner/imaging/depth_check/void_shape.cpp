#include "planner/imaging/depth_check/void_shape.hpp"

#include <algorithm>
#include <cmath>

namespace biopsy::imaging {
namespace {

double ramp(double x, double soft) {
  return std::clamp(0.5 + 0.5 * x / soft, 0.0, 1.0);
}

}  // namespace

double VoidShape::covers(double t, double u, double v) const {
  if (t > depth + soft) return 0.0;
  const double du = u - line.u - line.u_slope * t, dv = v - line.v - line.v_slope * t;
  const double from_axis = std::sqrt(du * du + dv * dv);
  if (from_axis > line.radius_mm + soft) return 0.0;
  const double rim = std::min(from_axis / line.radius_mm, 1.0);
  const double end = depth - rounding * line.radius_mm * (1.0 - std::sqrt(1.0 - rim * rim));
  return ramp(line.radius_mm - from_axis, soft) * ramp(end - t, soft);
}

double coverage(const Corridor& corridor, const CorridorVoxel& voxel, const VoidShape& shape) {
  const std::vector<Eigen::Vector3d>& places = corridor.stacks[voxel.stack].places;
  double sum = 0.0;
  for (const Eigen::Vector3d& place : places)
    sum += shape.covers(static_cast<double>(voxel.t) + place.x(), static_cast<double>(voxel.u) + place.y(),
                        static_cast<double>(voxel.v) + place.z());
  return sum / static_cast<double>(places.size());
}

}  // namespace biopsy::imaging
