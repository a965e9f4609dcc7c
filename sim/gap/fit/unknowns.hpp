// A hypothesis: a model with unknown parameters. Each unknown is one coordinate theta of a search, scaled so
// that its uncertainty is about 1.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "sim/gap/fit/library.hpp"
#include "sim/gap/select/evidence_runs.hpp"

namespace biopsy::sim::gap {

inline constexpr int kBaseline = -1;
inline constexpr int kTerm = -2;
inline constexpr std::size_t kTermMemory = kMostTermParts, kTermPeriod = kMostTermParts + 1,
                             kTermExponent = kMostTermParts + 2;
inline constexpr std::size_t kTermUnknowns = kMostTermParts + 3;  // coefficients, and these

struct Unknown {
  int effect = kBaseline;  // index in library(), kBaseline or kTerm
  // Of the effect; index in uncertain_baseline(); of the model's terms kTermUnknowns each.
  std::size_t parameter = 0;
  bool logarithmic = false;  // value = scale exp(theta), else scale theta
  double scale = 1.0;        // SI
  double theta = 0.0;        // present value
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  double prior_mean = 0.0;
  double prior_std = std::numeric_limits<double>::infinity();  // of theta; infinite: no prior
  double std = std::numeric_limits<double>::quiet_NaN();       // after a fit

  double value(double at) const;  // SI, at a theta
  double value() const { return value(theta); }
  double value_std() const;  // SI, of the value
  double theta_of(double si) const;
};

struct Hypothesis {
  PlantModel model;  // with every effect of `unknowns` present, unknowns at their theta
  std::vector<Unknown> unknowns;

  PlantModel at(const std::vector<double>& thetas) const;
  void set(const std::vector<double>& thetas);
  double prior_cost() const;  // sum of squared deviations from the priors, in their standard deviations
};

// A baseline parameter whose calibration may be wrong. Masses are weighed and pouches counted: a wrong mass
// is the effect added_mass.
struct UncertainParameter {
  std::string_view name;
  double Baseline::*member;
  bool calibrated;  // known up to small errors: has a prior in every hypothesis
  bool candidate;   // may be selected; the others act only together with one that is
};
const std::vector<UncertainParameter>& uncertain_baseline(Drive drive);

// The given model up to small calibration errors, the named baseline parameters without prior. Parameters of
// effects that the model has already have wider priors (30 %). Throws ConfigError for a name that is no
// parameter of this drive.
Hypothesis baseline_hypothesis(const PlantModel& model, const std::vector<std::string>& free);

// Adds the coefficients of the model's i-th term as unknowns, and those that it has of the time of its
// memory, its period and its exponent.
void add_term_unknowns(Hypothesis& hypothesis, std::size_t term);
// Removes the model's last term with its unknowns.
void remove_last_term(Hypothesis& hypothesis);

// Removes the prior of one baseline parameter.
void free_parameter(Hypothesis& hypothesis, std::size_t baseline_parameter);

// Adds an effect, with these SI values as the start of a search.
void add_effect(Hypothesis& hypothesis, int effect, const std::vector<double>& start,
                const Evidence& evidence);

}  // namespace biopsy::sim::gap
