// From a target on the image to a sealed plan of insertion steps, or the reason why there is none.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "planner/plan/insertion_steps.hpp"
#include "planner/plan/nominal_stage.hpp"
#include "robot/msg/plan.hpp"

namespace biopsy::planner {

// What the target must satisfy. A request may be stricter than these defaults, never looser.
struct Tolerances {
  // Nothing moves the needle sideways: what is off the axis stays off. 1 mm keeps the needle inside a 5 mm
  // lesion, the smallest that is sampled as a rule, with as much again for registration.
  Millimetres axis_offset{1.0};
  // Entry on the image against the tip by registration. Catches a wrong frame (LPS typed as RAS) or patient.
  Millimetres entry_offset{1.0};
  double fre_mm = 1.0;  // as kFreLimit_mm
  double tre_mm = 1.0;  // expected error at the target: not larger than the offset that is tolerated there
};

// Less than this is not a step: the paper's loop does not hold low targets (IV.D), and the needle counts as
// withdrawn.
inline constexpr Millimetres kTargetMin{0.5};
// Weakest tissue a plan may count on; a stage that cannot hold the target against it at full drive is
// refused.
inline constexpr double kTissueForceMin_N = 0.3;

// Half of what a 50 ms reaction and a 1 mm margin allow (20 mm/s), and half again for a needle that pops
// through.
inline constexpr MillimetresPerSecond kSpeedMax{5.0};
inline constexpr Seconds kDwellMax{10.0};

struct InsertionRequest {
  Target target;
  RigidTransform X_SR = RigidTransform::Identity();
  double registration_fre_mm = 0.0, registration_tre_mm = 0.0;  // 0 where the transform was given
  std::vector<Layer> layers;
  Grams weight{50.0};
  NominalStage stage{};
  std::vector<Millimetres> waypoints;  // depths asked for on the way, rising
  Staging staging = Staging::Automatic;
  Pace pace;
  PiGains gains{};
  std::optional<TipOffset> tip_offset = std::nullopt;
  Tolerances tolerances;
};

// The plan is sealed. Refuses, with distance and remedy: a transform that is not rigid, too large FRE or TRE,
// an entry away from the needle tip, a target behind the tip, off its axis, too near or beyond the stroke,
// layers that do not reach the target, waypoints that do not rise to it, a weight or a tissue the stage
// cannot lift against.
std::variant<Plan, PlanRefusal> plan_insertion(const InsertionRequest& request);

}  // namespace biopsy::planner
