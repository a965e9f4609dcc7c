// Looks for a seeded bug: explores until enough is broken, and says what and how.
#pragma once

#include <string>
#include <vector>

#include "bugs.hpp"
#include "subject.hpp"

namespace biopsy::explore {

struct Catch {
  std::vector<std::string> claims;   // that broke, in the order of their tables
  std::vector<std::string> stories;  // one a claim
};

// `known`: claims that break without the bug as well, and so do not show it.
Catch find_violation(const Subject& subject, Part part, const std::vector<std::string>& known);

}  // namespace biopsy::explore
