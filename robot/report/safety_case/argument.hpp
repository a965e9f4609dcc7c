// The argument as a picture in Goal Structuring Notation (GSN Community Standard): goals as boxes, strategies
// as parallelograms, contexts rounded, solutions as circles. In graphviz's language, to be drawn by `dot`.
#pragma once

#include <string>
#include <vector>

#include "robot/report/safety_case/safety_case.hpp"

namespace biopsy::safety_case {

// Claim -> strategy -> hazards -> requirements -> evidence. What a gap names is drawn as an alarm.
std::string argument_dot(const SafetyCase& safety_case, const std::vector<Finding>& findings,
                         const std::vector<Gap>& gaps);

}  // namespace biopsy::safety_case
