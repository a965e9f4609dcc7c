// A plan as markups of 3D Slicer.
#pragma once

#include <string>

#include "robot/msg/plan.hpp"

namespace biopsy::planner {

// A .mrk.json file (schema 1.0.3, LPS mm): the line "plan" from the point "entry" to the point "target", and
// the list "stages" with the tip's place at the end of each step.
std::string plan_markups(const Plan& plan);

}  // namespace biopsy::planner
