// What the programs that give evidence write, read strictly; and findings as they are kept in a case's
// folder.
#pragma once

#include <string>

#include "robot/report/safety_case/safety_case.hpp"

namespace biopsy::safety_case {

// Fill in `passed`, `figures`, `tables`, `tests` of a finding from the JSON text of a source. `name`: of the
// file, for errors. A test program gives the figures "tests" and "failed", and the largest of each number
// that its tests recorded. Throw ConfigError.
void read_proof(const std::string& text, const std::string& name, Finding& finding);
void read_tests(const std::string& text, const std::string& name, Finding& finding);

std::string to_json(const Finding& finding);
Finding finding_from_json(const std::string& text, const std::string& name);

}  // namespace biopsy::safety_case
