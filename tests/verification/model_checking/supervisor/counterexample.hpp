// A counterexample tick by tick from Boot, on the real function: inputs, what the supervisor did, and the
// violated claim.
#pragma once

#include <string>

#include "tests/verification/model_checking/supervisor/explorer.hpp"

namespace biopsy::model_checking {

// `claim` must have been broken in `exploration`.
std::string counterexample_text(const Subject& subject, const PlanFacts& plan, const Explorer& explorer,
                                const Exploration& exploration, std::size_t claim);

}  // namespace biopsy::model_checking
