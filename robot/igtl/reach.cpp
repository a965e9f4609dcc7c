#include "robot/igtl/reach.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/plan/plan_insertion.hpp"
#include "planner/plan/registration.hpp"
#include "robot/common/config_error.hpp"
#include "safety/types/limits.hpp"

namespace biopsy::igtl {
namespace {

constexpr double kFarthest_mm = 2'000.0;
constexpr Millimetres kDeepest = from_um(limits::kStroke_um - limits::kDepthMargin_um);

std::array<double, 16> rows_of(const Transform& transform) {
  std::array<double, 16> rows{};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      rows[4 * row + column] = static_cast<double>(transform.columns[3 * column + row]);
  rows[15] = 1.0;
  return rows;
}

}  // namespace

std::variant<RigidTransform, Refused> calibration_of(const Transform& robot_to_ras) {
  try {
    const RigidTransform X_SR = planner::rigid_transform_from_ras(rows_of(robot_to_ras), "TRANSFORM");
    const double far_mm = X_SR.translation().norm();
    if (far_mm > kFarthest_mm)
      return Refused{
          fmt::format("the robot would stand {:.0f} mm from the isocentre: send millimetres", far_mm)};
    return X_SR;
  } catch (const ConfigError& error) {
    return Refused{error.what_is_wrong};
  }
}

std::variant<Reachable, Refused> reach(const RigidTransform& X_SR, const Transform& target_in_ras) {
  const auto& sent = target_in_ras.columns;
  if (!std::ranges::all_of(sent, [](float value) { return std::isfinite(value); }))
    return Refused{"the target has an entry that is not a number"};
  Reachable target;
  target.p_ST = lps_from_ras(Point(sent[9], sent[10], sent[11]));
  const Point p_RT = X_SR.inverse() * target.p_ST;
  target.depth = Millimetres(p_RT.z());
  target.axis_offset = Millimetres(std::hypot(p_RT.x(), p_RT.y()));
  const Millimetres tolerated = planner::Tolerances{}.axis_offset;
  if (target.axis_offset > tolerated)
    return Refused{fmt::format("{:.1f} mm off the needle axis; {:.1f} mm are tolerated",
                               target.axis_offset.value, tolerated.value)};
  if (target.is_at_entry()) return target;
  if (target.depth.value < 0.0)
    return Refused{fmt::format("{:.1f} mm behind the needle tip", -target.depth.value)};
  if (target.depth < planner::kTargetMin)
    return Refused{
        fmt::format("{:.2f} mm deep; a step needs {:.1f} mm", target.depth.value, planner::kTargetMin.value)};
  if (target.depth > kDeepest)
    return Refused{fmt::format("{:.1f} mm deep, {:.1f} mm beyond the reach of {:.1f} mm", target.depth.value,
                               (target.depth - kDeepest).value, kDeepest.value)};
  return target;
}

Transform tip_at(const RigidTransform& X_SR, Millimetres depth) {
  const Point tip = ras_from_lps(X_SR * Point(0, 0, depth.value));
  Transform pose;
  for (int column = 0; column < 3; ++column) {
    const Point axis = ras_from_lps(X_SR.linear().col(column));
    for (int row = 0; row < 3; ++row)
      pose.columns[static_cast<std::size_t>(3 * column + row)] = static_cast<float>(axis(row));
  }
  for (int row = 0; row < 3; ++row)
    pose.columns[static_cast<std::size_t>(9 + row)] = static_cast<float>(tip(row));
  return pose;
}

}  // namespace biopsy::igtl
