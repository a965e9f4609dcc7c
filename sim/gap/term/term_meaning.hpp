// What a proposed force may be physically, for people: a hint, not a finding.
#pragma once

#include <string>

#include "sim/term/term.hpp"

namespace biopsy::sim::gap {

// By the factors of the product that acts most. A noun phrase.
std::string term_meaning(const TermPowers& strongest, bool on_stack);

}  // namespace biopsy::sim::gap
