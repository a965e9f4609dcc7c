// A sealed plan: staged depth setpoints along the needle's one degree of freedom. Depth is the displacement
// of the needle from where it waits, positive into the patient.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "robot/common/sha256.hpp"
#include "robot/common/units.hpp"
#include "robot/msg/target.hpp"

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
  Millimetres depth;            // where the stage ends
  MillimetresPerSecond speed;   // limit on the setpoint's rate
  Volts v_max;                  // limit on the drive: what it can store ahead of a boundary, model-based
  Seconds dwell{0};             // time within tolerance before the stage counts as reached
  bool image_confirms = false;  // must a depth check on a new image pass before the next stage
  std::string why;              // for a person: "stop short of muscle | gap at 2.00 mm"
};

// Band of depths that are plausible at a steady drive amplitude, for the offset and scale check.
struct DepthBand {
  Volts drive;
  Millimetres low, high;
};

struct PlanLimits {
  Millimetres depth_max;             // the target plus the allowed overshoot; never beyond the stroke
  Volts v_max;                       // highest drive of any stage
  std::vector<DepthBand> plausible;  // rising drive
};

// What only a plan for the bench may ask for: the stage alone, no patient and no needle on it.
struct BenchDrive {
  Seconds half_period{0.25};  // between two changes of polarity; every plan with a patient has 0.25 s (2 Hz)
};

struct Plan {
  Target target;
  RigidTransform X_SR = RigidTransform::Identity();             // robot to scanner
  double registration_fre_mm = 0.0, registration_tre_mm = 0.0;  // 0 where the transform was given
  Millimetres target_depth;
  Millimetres axis_offset;  // distance of the target from the needle axis
  std::vector<Layer> layers;
  std::vector<InsertionStep> stages;
  PlanLimits limits;
  std::optional<BenchDrive> bench = std::nullopt;  // not for a patient
  Sha256 seal{};                                   // SHA-256 over all of the above

  std::string layer_at(Millimetres depth) const {
    for (const Layer& layer : layers)
      if (depth >= layer.from && depth < layer.to) return layer.name;
    return "unknown";
  }
};

// Why there is no plan, and what a person can do about it.
struct PlanRefusal {
  std::string what;
  std::string remedy;
};

}  // namespace biopsy
