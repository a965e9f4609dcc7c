#include "planner/imaging/depth_check/reflected_lines.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace biopsy::imaging {
namespace {

constexpr double kAlong = 0.26;        // sine of 15 degrees
constexpr double kSamePlace_mm = 0.5;  // and
constexpr double kSameSlope = 0.02;    // a degree

// (t, u, v) of the first voxel of a stack, whether or not the corridor holds it.
std::optional<Eigen::Vector3d> origin_of(const Corridor& corridor, const Stack& stack) {
  for (std::size_t row = 0; row + 1 < stack.rows.size(); ++row) {
    if (stack.rows[row] == stack.rows[row + 1]) continue;
    const CorridorVoxel& voxel = corridor.voxels[stack.rows[row]];
    const auto n = static_cast<int>(voxel.cell);
    const Eigen::Vector3d index(n % stack.size.x(), n / stack.size.x() % stack.size.y(),
                                n / (stack.size.x() * stack.size.y()));
    return Eigen::Vector3f(voxel.t, voxel.u, voxel.v).cast<double>() - stack.steps * index;
  }
  return std::nullopt;
}

}  // namespace

std::vector<PlacedLine> reflected_lines(const Corridor& corridor, const PlacedLine& seen) {
  const Eigen::Vector3d along(1.0, seen.line.u_slope, seen.line.v_slope);
  const Eigen::Vector3d end = Eigen::Vector3d(0.0, seen.line.u, seen.line.v) + seen.depth_mm * along;
  std::vector<PlacedLine> reflected;
  for (const Stack& stack : corridor.stacks) {
    const double apart_mm = stack.steps.col(2).norm();
    const Eigen::Vector3d normal = stack.steps.col(2) / apart_mm;
    const auto origin = origin_of(corridor, stack);
    if (!origin || std::abs(normal.dot(along.normalized())) > kAlong) continue;
    const double off_first_mm = normal.dot(end - *origin);
    const int slice =
        std::clamp(static_cast<int>(std::lround(off_first_mm / apart_mm)), 0, stack.size.z() - 1);
    if (slice > 0 && slice < stack.size.z() - 1) continue;  // its neighbours tell the side
    const Eigen::Vector3d there = end - 2.0 * (off_first_mm - slice * apart_mm) * normal;
    const Eigen::Vector3d turned = along - 2.0 * normal.dot(along) * normal;
    PlacedLine other{seen.line, there.x()};
    other.line.u_slope = turned.y() / turned.x(), other.line.v_slope = turned.z() / turned.x();
    other.line.u = there.y() - there.x() * other.line.u_slope;
    other.line.v = there.z() - there.x() * other.line.v_slope;
    if ((there - end).norm() > kSamePlace_mm || (turned - along).norm() > kSameSlope)
      reflected.push_back(other);
  }
  return reflected;
}

}  // namespace biopsy::imaging
