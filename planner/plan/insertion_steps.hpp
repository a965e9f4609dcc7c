// Where the needle stops on its way: short of each tissue boundary, behind it, where the operator asked, and
// at the target.
#pragma once

#include <vector>

#include "planner/plan/nominal_model.hpp"
#include "robot/msg/plan.hpp"

namespace biopsy::planner {

enum class Staging : std::uint8_t {
  Automatic,  // stops at every boundary; waypoints are added to them
  AsGiven,    // only the waypoints, then the target; no waypoint means straight to the target
};

struct Pace {
  MillimetresPerSecond speed{
      1.0};  // inside a layer: 1/20 of what the 50 ms reaction time and 1 mm margin allow
  MillimetresPerSecond crossing{
      0.5};            // near a boundary: half of that, so less force builds up before it shows
  Seconds dwell{1.0};  // four polarity changes of the 2 Hz drive: a steady depth, not a passing one
};

// The loop's settled error is 0.07 mm rms (paper IV.F); three times that and 0.1 mm of final error make 0.3
// mm: a stop this far from a boundary is on the side it says.
inline constexpr Millimetres kStopShort{0.3};
inline constexpr Millimetres kStopBehind{0.3};
// Stops closer than this are one stop: three times the settled error, so the loop cannot tell them apart
// sooner.
inline constexpr Millimetres kStepMin{0.2};

// Steps with strictly rising depths; the last is the target. Boundaries that are too close for a stop
// between them are crossed in one step. Speed is `crossing` in every step that comes within kStopShort of a
// boundary. An image confirms the last stop before the layer of the target, every waypoint and the target.
// `waypoints` must rise inside (0, target) and the layers must cover the target (asserted: plan_insertion
// refuses before).
std::vector<InsertionStep> plan_steps(const std::vector<Layer>& layers, Millimetres target,
                                      const std::vector<Millimetres>& waypoints, Staging staging,
                                      const Pace& pace, const NominalModel& model);

}  // namespace biopsy::planner
