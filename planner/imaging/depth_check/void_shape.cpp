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
  const double side = ramp(line.radius_mm - from_axis, soft);
  if (t < depth - rounding * line.radius_mm - soft) return side;  // the end is far
  const double rim = std::min(from_axis / line.radius_mm, 1.0);
  const double end = depth - rounding * line.radius_mm * (1.0 - std::sqrt(1.0 - rim * rim));
  return side * ramp(end - t, soft);
}

double coverage(const Corridor& corridor, const CorridorVoxel& voxel, const VoidShape& shape) {
  const Stack& stack = corridor.stacks[voxel.stack];
  const std::vector<Eigen::Vector3d>& places = stack.places;
  const auto t = static_cast<double>(voxel.t), u = static_cast<double>(voxel.u),
             v = static_cast<double>(voxel.v);
  const VoidLine& line = shape.line;
  const double du = u - line.u - line.u_slope * t, dv = v - line.v - line.v_slope * t;
  const double touched =
      line.radius_mm + shape.soft + stack.reach_mm * (1.0 + std::abs(line.u_slope) + std::abs(line.v_slope));
  if (t - stack.reach_mm > shape.depth + shape.soft || du * du + dv * dv > touched * touched) return 0.0;
  double sum = 0.0;
  for (const Eigen::Vector3d& place : places)
    sum += shape.covers(t + place.x(), u + place.y(), v + place.z());
  return sum / static_cast<double>(places.size());
}

}  // namespace biopsy::imaging
