// Where the needle can go: the axis by the calibration that a navigation program sends, and what lies on it.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "robot/common/frames.hpp"
#include "robot/common/units.hpp"
#include "robot/igtl/message.hpp"

namespace biopsy::igtl {

// The tip counts as at its target within this: the depth that sites ask for.
inline constexpr Millimetres kAtTarget{0.1};

// A target on the needle's axis.
struct Reachable {
  Point p_ST = Point::Zero();  // as it was sent, LPS mm
  Millimetres depth;           // along the axis, from where the tip waits
  Millimetres axis_offset;     // distance of the target from the axis
  // The tip is there before the needle was moved: nothing to insert.
  bool is_at_entry() const { return std::abs(depth.value) <= kAtTarget.value; }
};

struct Refused {
  std::string why;
};

// Robot to scanner from TRANSFORM(CLB_n), RAS mm. Refuses what is no rotation and translation, or is farther
// than 2 m from the isocentre: the units are wrong.
std::variant<RigidTransform, Refused> calibration_of(const Transform& robot_to_ras);

// Of the orientation only that it is a number is asked: the needle has the direction of its guide. Refuses,
// with the distance, what is off the axis, behind the tip, too near for a step or beyond the stroke.
std::variant<Reachable, Refused> reach(const RigidTransform& X_SR, const Transform& target_in_ras);

// The tip at a depth, RAS mm; its third column is the direction of insertion.
Transform tip_at(const RigidTransform& X_SR, Millimetres depth);

}  // namespace biopsy::igtl
