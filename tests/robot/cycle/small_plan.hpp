// A sealed plan to 3 mm, made by hand.
#pragma once

#include <utility>
#include <vector>

#include "planner/plan/seal.hpp"

namespace biopsy::robot {

// A step to each depth, each confirmed by an image.
inline Plan small_plan(const std::vector<double>& depths_mm, std::vector<DepthBand> plausible) {
  Plan plan;
  plan.target_depth = Millimetres(3.0);
  plan.limits = {.depth_max = Millimetres(4.0), .v_max = Volts(5000), .plausible = std::move(plausible)};
  for (const double depth_mm : depths_mm)
    plan.steps.push_back({.depth = Millimetres(depth_mm),
                          .speed = MillimetresPerSecond(1.0),
                          .v_max = Volts(5000),
                          .dwell = Seconds(0.5),
                          .image_confirms = true,
                          .why = ""});
  planner::seal(plan);
  return plan;
}

}  // namespace biopsy::robot
