// A sealed plan: depth setpoints in steps along the needle's one degree of freedom. Depth is the displacement
// of the needle tip from the entry, positive into the patient.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "robot/common/sha256.hpp"
#include "robot/common/units.hpp"
#include "robot/msg/target.hpp"
#include "robot/msg/tip_offset.hpp"

namespace biopsy {

struct Layer {
  std::string name;
  Millimetres from, to;  // along the path, 0 = entry

  Millimetres thickness() const { return to - from; }
};

enum class StepKind : std::uint8_t {
  Approach,  // inside a layer, stops short of a boundary
  Cross,     // through a boundary, slowly
  Waypoint,  // a depth the operator asked for on the way
  Target,    // the depth of the biopsy
};

struct InsertionStep {
  StepKind kind = StepKind::Approach;
  Millimetres depth;           // at the end of the step
  MillimetresPerSecond speed;  // limit of the setpoint's rate
  Volts v_max;       // limit of the drive: bounds the energy stored ahead of a boundary (from the model)
  Seconds dwell{0};  // time within tolerance before the step counts as reached
  bool image_confirms = false;  // a depth check on a new image must pass before the next step
  std::string why;              // reason, for display: "stop short of muscle | gap at 2.00 mm"
};

// Depths that are plausible at a steady drive amplitude, for the check of sensor offset and scale.
struct DepthBand {
  Volts drive;
  Millimetres low, high;
};

struct PlanLimits {
  Millimetres depth_max;             // the target plus the allowed overshoot; never beyond the stroke
  Volts v_max;                       // highest drive of any step
  std::vector<DepthBand> plausible;  // in order of rising drive
};

// For a plan on the bench only: the stage alone, without patient and needle.
struct BenchDrive {
  Seconds half_period{0.25};  // between two changes of polarity; 0.25 s (2 Hz) in every plan with a patient
};

// Of the PI loop, eq. (22). The defaults are the paper's, IV.D.
struct PiGains {
  double proportional_V_per_mm = 800.0;     // K_p = 0.8 kV/mm
  double integral_V_per_mm_per_tick = 5.0;  // K_i = 0.005 kV/mm at each 1 ms tick

  bool operator==(const PiGains&) const = default;
};

// What may be sealed: a sixteenth to five times the paper's K_p, a 25th to ten times its K_i. Below, the loop
// does not bring the needle to its depth within a step; above, no stage that was measured has a margin.
inline constexpr PiGains kLeastGains{50.0, 0.2}, kMostGains{4000.0, 50.0};

constexpr bool is_permitted(const PiGains& gains) {
  return gains.proportional_V_per_mm >= kLeastGains.proportional_V_per_mm &&
         gains.proportional_V_per_mm <= kMostGains.proportional_V_per_mm &&
         gains.integral_V_per_mm_per_tick >= kLeastGains.integral_V_per_mm_per_tick &&
         gains.integral_V_per_mm_per_tick <= kMostGains.integral_V_per_mm_per_tick;
}

struct Plan {
  Target target;
  RigidTransform X_SR = RigidTransform::Identity();             // robot to scanner
  double registration_fre_mm = 0.0, registration_tre_mm = 0.0;  // 0 where the transform was given
  Millimetres target_depth;
  Millimetres axis_offset;  // distance of the target from the needle axis
  std::vector<Layer> layers;
  std::vector<InsertionStep> steps;
  PlanLimits limits;
  PiGains gains{};
  std::optional<BenchDrive> bench = std::nullopt;  // absent: a plan for a patient
  // Of the needle in its sequence; absent: no image of it is accepted.
  std::optional<TipOffset> tip_offset = std::nullopt;
  Sha256 seal{};  // SHA-256 over all of the above

  std::string layer_at(Millimetres depth) const {
    for (const Layer& layer : layers)
      if (depth >= layer.from && depth < layer.to) return layer.name;
    return "unknown";
  }
};

// Why there is no plan, and the remedy.
struct PlanRefusal {
  std::string what;
  std::string remedy;
};

}  // namespace biopsy
