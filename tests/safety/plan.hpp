// The plan of most tests of safety/.
#pragma once

#include "safety/types/plan_facts.hpp"

namespace biopsy::safety {

inline PlanFacts three_step_plan() {
  PlanFacts plan;
  plan.plan_tag = 0xB10B'0001;
  plan.config_tag = 0xC0F1'6001;
  plan.depth_max_um = 4'000;
  plan.tissue_residual_max_um = 500;
  plan.step_count = 3;
  plan.steps[0] = {3'600, 6'500'000, 20'000, false};
  plan.steps[1] = {3'800, 7'000'000, 20'000, true};
  plan.steps[2] = {4'000, 7'500'000, 20'000, true};
  plan.band_count = 3;
  plan.bands[0] = {0, -100, 100};
  plan.bands[1] = {4'000'000, 1'700, 2'300};
  plan.bands[2] = {8'000'000, 3'600, 4'400};
  return plan;
}

}  // namespace biopsy::safety
