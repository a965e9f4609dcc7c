// Equations fitted by simulation, and how many products are worth having.
#pragma once

#include <limits>
#include <stop_token>
#include <vector>

#include "sim/gap/select/select.hpp"

namespace biopsy::sim::gap {

struct FittedTerm {
  Hypothesis hypothesis;                                    // the term is the model's last
  double square = std::numeric_limits<double>::infinity();  // training rows
  double excess = std::numeric_limits<double>::infinity();  // what counts of it: no less than is tolerated

  const Term& term() const { return hypothesis.model.terms.back(); }
};

// Best first: the shortest that leaves nearly as little as any, without products that it does as well
// without. Suggested twice: from the model's calibration and the measured motion, then from the best of
// these.
std::vector<FittedTerm> fitted_terms(const Hypothesis& start, const Evidence& coarse,
                                     const std::stop_token& stop);

// On fine rows; with the readings outweighing the priors where nothing but noise is left.
FittedTerm converged(const FittedTerm& term, double square_before, const Evidence& fine);

// Without the products whose coefficients are not known to better than half of themselves; the rest has
// standard deviations.
FittedTerm without_unknown_products(FittedTerm term, double square_before, const Evidence& fine);

// Of a coefficient or of a time of memory, SI.
bool is_known(const Unknown& unknown);

// Of two that leave as little.
bool leaves_as_little(const FittedTerm& one, const FittedTerm& other);

}  // namespace biopsy::sim::gap
