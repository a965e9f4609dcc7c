// Checks the links of the case in both directions, and its evidence against the acceptance criteria.
#pragma once

#include <vector>

#include "robot/report/safety_case/safety_case.hpp"

namespace biopsy::safety_case {

// In the case as written: an id twice, a link to nothing, a requirement that no hazard needs, a hazard
// without test, and what gaps_in_risks() finds. A hazard without requirement needs a risk that is declared
// open.
std::vector<Gap> gaps_in_argument(const SafetyCase& safety_case);

// Between the case and what was found for `build`: a requirement without a passed test that names it, a test
// that names no requirement of the case, a hazard's test that did not pass or names none of its requirements,
// a proof that is missing, stale, failed or below its criterion. In a quick build the sources outside the
// subset are not asked for, and criteria are not judged.
std::vector<Gap> gaps_in_evidence(const SafetyCase& safety_case, const std::vector<Finding>& findings,
                                  const Build& build);

// Whether the figure exists and meets the criterion.
bool is_met(const Criterion& criterion, const Finding& finding);

const Finding* finding_of(const std::vector<Finding>& findings, const std::string& source);

// Passed tests that name a requirement.
std::vector<const TestResult*> tests_for(const std::vector<Finding>& findings,
                                         const std::string& requirement);

}  // namespace biopsy::safety_case
