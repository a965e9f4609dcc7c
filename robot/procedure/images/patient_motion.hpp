// How far the patient moved since the image of the plan, as the registration of a confirmation image shows
// it: what feeds hazard H-22, and a reason of its own not to accept an image. The needle stands in the
// scanner, the target moves with the patient.
#pragma once

#include <cstdint>
#include <optional>

#include "robot/common/frames.hpp"
#include "robot/msg/depth_check.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::robot {

// The supervisor's limit, and where a registration, known to half a millimetre, no longer says that it
// holds.
inline constexpr double kPatientMotionMax_mm = safety::kPatientMotion_um * 1e-3;
inline constexpr double kPatientMotionSure_mm = kPatientMotionMax_mm - 0.5;

// The larger motion of entry and planned tip, mm. None where the two images could not be matched.
// `registration_min`: least correlation of a match.
std::optional<double> patient_motion_mm(const DepthCheck& check, const Direction& axis_S, Millimetres tip,
                                        double registration_min);

// For the supervisor, um. Images that cannot be matched say nothing about motion: what was known before
// stays.
void note_patient_motion(const DepthCheck& check, std::int32_t& motion_um);

// Sets check.patient_motion_mm, and takes an accept back: above the limit the image is rejected, near it
// unsure.
void judge_patient_motion(DepthCheck& check, const Direction& axis_S, Millimetres tip,
                          double registration_min);

}  // namespace biopsy::robot
