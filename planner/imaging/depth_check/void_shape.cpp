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
  const auto softness = static_cast<float>(0.5 / shape.soft), radius = static_cast<float>(line.radius_mm);
  const auto ramp = [&](const auto& inside_mm) { return (0.5f + softness * inside_mm).max(0.0f).min(1.0f); };
  const auto along = stack.places.col(0), across = stack.places.col(1), up = stack.places.col(2);
  const Eigen::Array<float, Eigen::Dynamic, 1, 0, kPlacesMost, 1> from_axis =
      ((static_cast<float>(du) + across - static_cast<float>(line.u_slope) * along).square() +
       (static_cast<float>(dv) + up - static_cast<float>(line.v_slope) * along).square())
          .sqrt();
  const auto side = ramp(radius - from_axis);
  const double cap = shape.rounding * line.radius_mm;
  if (t + stack.reach_mm < shape.depth - cap - shape.soft)
    return static_cast<double>(side.mean());  // the end is far
  const auto rim = (from_axis / radius).min(1.0f);
  const auto before_end = static_cast<float>(shape.depth - cap - t) +
                          static_cast<float>(cap) * (1.0f - rim.square()).sqrt() - along;
  return static_cast<double>((side * ramp(before_end)).mean());
}

}  // namespace biopsy::imaging
