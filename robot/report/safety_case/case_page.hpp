// The safety case for people and for programs.
#pragma once

#include <string>
#include <vector>

#include "robot/report/safety_case/safety_case.hpp"

namespace biopsy::safety_case {

// One page; its first screen is what an assessor can read in two minutes. `argument_svg`: the drawn argument,
// may be empty.
std::string case_html(const SafetyCase& safety_case, const std::vector<Finding>& findings,
                      const std::vector<Gap>& gaps, const Build& build, const std::string& argument_svg);

// safety-case.json; fields in docs/explanation/verification.md.
std::string case_json(const SafetyCase& safety_case, const std::vector<Finding>& findings,
                      const std::vector<Gap>& gaps, const Build& build);

// The argument in Goal Structuring Notation (GSN Community Standard): goals as boxes, strategies as
// parallelograms, contexts rounded, solutions as circles. In graphviz's language, to be drawn by `dot`. Claim
// -> strategy -> hazards -> requirements -> evidence. What a gap names is drawn as an alarm.
std::string argument_dot(const SafetyCase& safety_case, const std::vector<Finding>& findings,
                         const std::vector<Gap>& gaps);

// "0 gaps: ..." for the terminal.
std::string case_sentence(const SafetyCase& safety_case, const std::vector<Finding>& findings,
                          const std::vector<Gap>& gaps, const Build& build);

}  // namespace biopsy::safety_case
