// Searches for a seeded bug: explores until enough claims are violated; which, with counterexamples.
#pragma once

#include <string>
#include <vector>

#include "tests/verification/model_checking/seeded_bugs/bugs.hpp"
#include "tests/verification/model_checking/subject.hpp"

namespace biopsy::model_checking {

struct Violations {
  std::vector<std::string> claims;           // that broke, in the order of their tables
  std::vector<std::string> counterexamples;  // one a claim
};

// `known`: claims that break without the bug as well, and so do not show it.
Violations find_violation(const Subject& subject, Part part, const std::vector<std::string>& known);

}  // namespace biopsy::model_checking
