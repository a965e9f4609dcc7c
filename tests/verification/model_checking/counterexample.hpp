// A counter-example as a person reads it: tick by tick from Boot, on the real function, what people and
// sensors did, what the supervisor did, and which claim broke.
#pragma once

#include <string>

#include "explorer.hpp"

namespace biopsy::explore {

// `claim` must have been broken in `exploration`.
std::string story_of(const Subject& subject, const PlanFacts& plan, const Explorer& explorer,
                     const Exploration& exploration, std::size_t claim);

}  // namespace biopsy::explore
