#include "robot/procedure/images/patient_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace biopsy::robot {

std::optional<double> patient_motion_mm(const DepthCheck& check, const Direction& axis_S, Millimetres tip,
                                        double registration_min) {
  const Eigen::Map<const Eigen::Vector3d> shift(check.shift_mm), turned_deg(check.rotation_deg);
  if (!(check.registration_score >= registration_min) || !shift.allFinite() || !turned_deg.allFinite())
    return std::nullopt;
  const Eigen::Vector3d turned = turned_deg * (std::acos(-1.0) / 180.0);
  const double angle = turned.norm();
  const Eigen::Vector3d along = tip.value * axis_S;
  const Eigen::Vector3d carried = angle > 0.0 ? Eigen::AngleAxisd(angle, turned / angle) * along : along;
  return std::max(shift.norm(), (carried - along + shift).norm());
}

void note_patient_motion(const DepthCheck& check, std::int32_t& motion_um) {
  if (!check.patient_motion_mm) return;
  motion_um = static_cast<std::int32_t>(std::lround(1e3 * std::min(*check.patient_motion_mm, 1e3)));
}

void judge_patient_motion(DepthCheck& check, const Direction& axis_S, Millimetres tip,
                          double registration_min) {
  check.patient_motion_mm = patient_motion_mm(check, axis_S, tip, registration_min);
  if (!check.patient_motion_mm || check.verdict != DepthVerdict::Accept) return;
  const double moved_mm = *check.patient_motion_mm;
  if (moved_mm <= kPatientMotionSure_mm) return;
  const bool beyond = moved_mm > kPatientMotionMax_mm;
  check.verdict = beyond ? DepthVerdict::Reject : DepthVerdict::Unsure;
  check.reason = fmt::format(
      "The patient moved by {:.1f} mm since the image of the plan; {:.0f} mm are allowed{}. Withdraw and "
      "plan anew. {}",
      moved_mm, kPatientMotionMax_mm, beyond ? "" : ", and it is not certain that they were kept",
      check.reason);
}

}  // namespace biopsy::robot
