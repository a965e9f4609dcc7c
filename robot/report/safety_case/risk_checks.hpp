// Checks the links of the risk management file to hazards, requirements and evidence.
#pragma once

#include <vector>

#include "robot/report/safety_case/safety_case.hpp"

namespace biopsy::safety_case {

// A hazard without a risk, a requirement of a hazard that controls none of its risks, a control or an
// evidence that does not exist, a verdict that is not the matrix's, a probability that a control raises, an
// open risk without a word on what is missing, a threat or scenario without a test that is not declared open,
// one that is open while no risk of its hazard is, an id that appears twice.
std::vector<Gap> gaps_in_risks(const SafetyCase& safety_case);

std::vector<const Risk*> open_risks(const RiskFile& file);  // not acceptable

}  // namespace biopsy::safety_case
