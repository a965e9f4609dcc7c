#include "robot/report/gap/gap_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace biopsy::report {
namespace {

// What is not known counts as the worst, so that the order is one.
double or_worst(double value) {
  return std::isfinite(value) ? value : std::numeric_limits<double>::max();
}

auto rank(const GapCandidate& c) {
  return std::tuple(c.round, !c.chosen, !c.fitted, or_worst(-c.probability), or_worst(c.held_out_rmse),
                    or_worst(-c.score));
}

}  // namespace

std::vector<GapCandidate> ranked_candidates(std::vector<GapCandidate> candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const GapCandidate& a, const GapCandidate& b) { return rank(a) < rank(b); });
  return candidates;
}

}  // namespace biopsy::report
