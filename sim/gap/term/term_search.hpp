// Equations that a linear look at the residual suggests, with the coefficients it gives them.
#pragma once

#include <vector>

#include "sim/gap/select/select.hpp"
#include "sim/gap/term/dictionary.hpp"

namespace biopsy::sim::gap {

// Best first; of the fewest products that explain what more would not explain much better, and one with a
// product less. Each is `around` with the term as the model's last and its calibration moved along. A term
// that `around` ends with (`with_term`) is not kept: it is where the look is taken from. Only training rows
// count.
std::vector<Hypothesis> suggested_terms(const Hypothesis& around, bool with_term, const MotionRows& motion,
                                        const Evidence& evidence);

// Excess square that is too small to be worth a further product. m^2; `before`: mean square without a term
double term_tolerance(double before, const Evidence& evidence);

}  // namespace biopsy::sim::gap
