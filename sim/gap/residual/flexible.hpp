// What a smooth curve could explain: a force on plate A, an error of the reading or a number of the baseline
// as a function of one variable, without any physics. A named effect that explains less than such a curve is
// only flexible.
#pragma once

#include <string>
#include <vector>

#include "sim/gap/select/select.hpp"

namespace biopsy::sim::gap {

struct FlexibleFit {
  std::string acts;      // "force" on plate A, N; "reading", m; or a number of the baseline, "k"
  std::string variable;  // "speed", "position", "input", "time"
  double square = 0.0;   // m^2, mean square of the held-out residual that it leaves

  std::string name() const { return "smooth function of " + variable; }
};

// Each curve is a polynomial of third degree between all but the outermost readings of the variable, fitted
// to the training rows together with the unknowns of `start`; the variable is the measured one. Responses are
// linear in the curve's height. `numbers`: curves of the baseline's numbers too, which are taken to vary
// slowly. Best first; empty where the model diverges.
std::vector<FlexibleFit> fit_flexible(const ScoredModel& start, const Evidence& evidence,
                                      bool numbers = false);

}  // namespace biopsy::sim::gap
