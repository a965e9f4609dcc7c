// A hypothesis: a model some of whose numbers are unknown. Each unknown is one coordinate theta of a search,
// scaled so that a change of one is about as large as what is not known.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "sim/gap/fit/library.hpp"
#include "sim/gap/select/evidence_runs.hpp"

namespace biopsy::sim::gap {

inline constexpr int kBaseline = -1;

struct Unknown {
  int effect = kBaseline;     // index in library(), or a number of the baseline
  std::size_t parameter = 0;  // of the effect, or index in uncertain_baseline()
  bool logarithmic = false;   // value = scale exp(theta), else scale theta
  double scale = 1.0;         // SI
  double theta = 0.0;         // where the search stands
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  double prior_mean = 0.0;
  double prior_std = std::numeric_limits<double>::infinity();  // of theta; infinite: nothing is known
  double std = std::numeric_limits<double>::quiet_NaN();       // after a fit

  double value(double at) const;  // SI, at a theta
  double value() const { return value(theta); }
  double theta_of(double si) const;
};

struct Hypothesis {
  PlantModel model;  // with every effect of `unknowns` present, unknowns at their theta
  std::vector<Unknown> unknowns;

  PlantModel at(const std::vector<double>& thetas) const;
  void settle(const std::vector<double>& thetas);
  double prior_cost() const;  // sum of squares of what was moved against what is known
};

// A number of the baseline that a calibration may have wrong. Masses are weighed, pouches counted and g is g:
// a wrong mass is the effect added_mass.
struct UncertainNumber {
  std::string_view name;
  double Baseline::*member;
  bool calibrated;  // known up to small errors, so it moves a little in every hypothesis
  bool candidate;   // may be found wrong; the others enter only through one that is
};
const std::vector<UncertainNumber>& uncertain_baseline(Drive drive);

// The model as written up to small errors of calibration, the named numbers of the baseline free. Numbers of
// effects that it has already are known less well and may move by some tens of per cent. Throws ConfigError
// for a name that is none of this drive's.
Hypothesis baseline_hypothesis(const PlantModel& model, const std::vector<std::string>& free);

// One number of the baseline let go.
void release(Hypothesis& hypothesis, std::size_t baseline_number);

// An effect put in with these SI values as the start of a search.
void include(Hypothesis& hypothesis, int effect, const std::vector<double>& start, const Evidence& evidence);

}  // namespace biopsy::sim::gap
