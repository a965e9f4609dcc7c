#include "planner/imaging/depth_check/void_shape.hpp"

#include <cmath>

namespace biopsy::imaging {

// All places of a voxel at once, in expressions that Eigen computes in SIMD lanes: half of a check's time
// was spent here.
double coverage(const Corridor& corridor, const CorridorVoxel& voxel, const VoidShape& shape) {
  const Stack& stack = corridor.stacks[voxel.stack];
  const auto t = static_cast<double>(voxel.t), u = static_cast<double>(voxel.u),
             v = static_cast<double>(voxel.v);
  const VoidLine& line = shape.line;
  const double du = u - line.u - line.u_slope * t, dv = v - line.v - line.v_slope * t;
  const double touched =
      line.radius_mm + shape.soft + stack.reach_mm * (1.0 + std::abs(line.u_slope) + std::abs(line.v_slope));
  if (t - stack.reach_mm > shape.depth + shape.soft || du * du + dv * dv > touched * touched) return 0.0;
  const auto ramp = [&](const auto& inside_mm) {
    return (0.5 + (0.5 / shape.soft) * inside_mm).max(0.0).min(1.0);
  };
  const auto along = stack.places.col(0), across = stack.places.col(1), up = stack.places.col(2);
  const Eigen::Array<double, Eigen::Dynamic, 1, 0, kPlacesMost, 1> from_axis =
      ((du + across - line.u_slope * along).square() + (dv + up - line.v_slope * along).square()).sqrt();
  const auto side = ramp(line.radius_mm - from_axis);
  const double cap = shape.rounding * line.radius_mm;
  if (t + stack.reach_mm < shape.depth - cap - shape.soft) return side.mean();  // the end is far
  const auto rim = (from_axis / line.radius_mm).min(1.0);
  const auto before_end = shape.depth - cap * (1.0 - (1.0 - rim.square()).sqrt()) - t - along;
  return (side * ramp(before_end)).mean();
}

}  // namespace biopsy::imaging
