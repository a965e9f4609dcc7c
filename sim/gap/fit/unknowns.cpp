#include "sim/gap/fit/unknowns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robot/common/config_error.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kCalibrationError = 0.02;  // relative standard deviation of a careful calibration
constexpr double kEffectError = 0.3;        // and of an effect's parameter, which is harder to measure
constexpr double kFreeRange = 2.0;          // ln: a candidate may differ by a factor of e^2
constexpr double kUnknownRange = 14.0;      // ln: a parameter named by --free may have any order of magnitude
constexpr double kMemoryRange = 1.5;        // ln: between the times that were tried
constexpr double kPeriodRange = 0.3;        // ln: likewise, with room
constexpr double kExponentRange = 0.7;      // ln: from a fourth root to a line
constexpr double kShapeRange = 4.6;         // ln: a factor of 100, within the library's range

// Films and gain act only through K^2 eps_film/d_film^2: K represents the three.
const std::vector<UncertainParameter> kStack{{"K", &Baseline::K, true, true},
                                             {"tau", &Baseline::tau, true, true},
                                             {"V0", &Baseline::V0, true, true},
                                             {"H_0", &Baseline::H_0, true, true},
                                             {"tau_h", &Baseline::tau_h, true, true},
                                             {"k", &Baseline::k, true, true},
                                             {"c_k", &Baseline::c_k, true, true},
                                             {"c_s", &Baseline::c_s, true, true},
                                             {"L0", &Baseline::L0, false, true},
                                             {"d_film", &Baseline::d_film, false, false},
                                             {"eps_film", &Baseline::eps_film, false, false}};
const std::vector<UncertainParameter> kForce{
    {"m", &Baseline::m, true, true}, {"c_s", &Baseline::c_s, true, true}, {"k", &Baseline::k, true, true}};

Unknown baseline_unknown(const PlantModel& model, std::size_t index, double prior_std, double range) {
  const double now = model.baseline.*(uncertain_baseline(model.baseline.drive)[index].member);
  return {.parameter = index,
          .logarithmic = true,
          .scale = now,
          .low = -range,
          .high = range,
          .prior_std = prior_std};
}

double& term_number(PlantModel& model, std::size_t parameter) {
  Term& term = model.terms[parameter / kTermUnknowns];
  const std::size_t i = parameter % kTermUnknowns;
  if (i < kMostTermParts) return term.parts[i].coefficient;
  return i == kTermMemory ? term.memory_time : i == kTermPeriod ? term.period : term.exponent;
}

void write(PlantModel& model, const Unknown& unknown, double theta) {
  const double value = unknown.value(theta);
  if (unknown.effect == kTerm)
    term_number(model, unknown.parameter) = value;
  else if (unknown.effect == kBaseline)
    model.baseline.*(uncertain_baseline(model.baseline.drive)[unknown.parameter].member) = value;
  else
    library_effect(unknown.effect).set(model, unknown.parameter, value);
}

void bound_by_range(Unknown& u, const LibraryParameter& p) {
  if (u.logarithmic) {
    u.low = std::max(u.theta - kShapeRange, std::log(p.low / u.scale));
    u.high = std::min(u.theta + kShapeRange, std::log(p.high / u.scale));
  } else {
    u.low = p.low / u.scale;
    u.high = p.high / u.scale;
  }
  u.theta = std::clamp(u.theta, u.low, u.high);
}

Unknown effect_unknown(int effect, std::size_t index, double start, const Evidence& evidence) {
  const LibraryParameter& p = library_effect(effect).parameters[index];
  Unknown u{.effect = effect, .parameter = index};
  switch (p.role) {
    case Role::Strength:
      u.scale = start != 0.0 ? std::abs(start) : p.typical != 0.0 ? std::abs(p.typical) : 1.0;
      break;
    case Role::Shape:
      u.logarithmic = p.low > 0.0 && start > 0.0;
      u.scale = u.logarithmic ? start : std::max(std::abs(p.typical), 0.1 * (p.high - p.low));
      break;
    case Role::Place:
      u.scale = std::max(1e-9, evidence.x_high - evidence.x_low);
      break;
    case Role::Level:
      u.scale = std::max(1.0, evidence.u_max);
      break;
    case Role::Frequency:
      u.scale = 1.0 / (evidence.training_seconds + evidence.held_out_seconds);
      break;
    case Role::Phase:
      break;
  }
  u.theta = u.logarithmic ? std::log(start / u.scale) : start / u.scale;
  bound_by_range(u, p);
  return u;
}

// Parameters of an effect that the model has already; zero means absent.
void add_given_effect(Hypothesis& out, std::size_t effect) {
  const LibraryEffect& given = library()[effect];
  for (std::size_t i = 0; i < given.parameters.size(); ++i) {
    const LibraryParameter& p = given.parameters[i];
    const double now = given.get(out.model, i);
    if (now == 0.0 || p.role == Role::Phase || p.role == Role::Frequency) continue;
    Unknown u{
        .effect = static_cast<int>(effect), .parameter = i, .logarithmic = now > 0.0, .scale = std::abs(now)};
    u.theta = u.prior_mean = u.theta_of(now);
    u.low = -kFreeRange;
    u.high = kFreeRange;
    u.prior_std = kEffectError;
    if (u.logarithmic && p.high > 0.0) u.high = std::min(u.high, std::max(0.0, std::log(p.high / now)));
    if (u.logarithmic && p.low > 0.0) u.low = std::max(u.low, std::min(0.0, std::log(p.low / now)));
    out.unknowns.push_back(u);
  }
}

}  // namespace

double Unknown::value(double at) const {
  return logarithmic ? scale * std::exp(at) : scale * at;
}

double Unknown::value_std() const {
  return (logarithmic ? value() : std::abs(scale)) * std;
}

double Unknown::theta_of(double si) const {
  return logarithmic ? std::log(si / scale) : si / scale;
}

PlantModel Hypothesis::at(const std::vector<double>& thetas) const {
  PlantModel out = model;
  for (std::size_t i = 0; i < unknowns.size(); ++i) write(out, unknowns[i], thetas[i]);
  return out;
}

void Hypothesis::set(const std::vector<double>& thetas) {
  for (std::size_t i = 0; i < unknowns.size(); ++i) unknowns[i].theta = thetas[i];
  model = at(thetas);
}

double Hypothesis::prior_cost() const {
  double cost = 0.0;
  for (const Unknown& u : unknowns)
    if (std::isfinite(u.prior_std)) cost += std::pow((u.theta - u.prior_mean) / u.prior_std, 2);
  return cost;
}

const std::vector<UncertainParameter>& uncertain_baseline(Drive drive) {
  return drive == Drive::Force ? kForce : kStack;
}

Hypothesis baseline_hypothesis(const PlantModel& model, const std::vector<std::string>& free) {
  Hypothesis out{.model = model, .unknowns = {}};
  const auto& numbers = uncertain_baseline(model.baseline.drive);
  std::vector<std::string_view> known;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    known.push_back(numbers[i].name);
    const bool is_free = std::find(free.begin(), free.end(), numbers[i].name) != free.end();
    const bool is_zero = model.baseline.*(numbers[i].member) == 0.0;
    if (is_free && is_zero)
      throw ConfigError(fmt::format("`{}` is to be fitted and is 0 in the model", numbers[i].name), "--free",
                        "give it a value of the right order of magnitude, or leave it out of --free");
    if (is_zero) continue;  // the stage has no such part
    if (is_free)
      out.unknowns.push_back(
          baseline_unknown(model, i, std::numeric_limits<double>::infinity(), kUnknownRange));
    else if (numbers[i].calibrated)
      out.unknowns.push_back(baseline_unknown(model, i, kCalibrationError, kFreeRange));
  }
  for (std::size_t i = 0; i < library().size(); ++i)
    if (library()[i].present(model)) add_given_effect(out, i);
  for (const std::string& name : free)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw ConfigError(fmt::format("\"{}\" is no number that can be fitted", name), "--free",
                        fmt::format("use {}", fmt::join(known, ", ")));
  return out;
}

void free_parameter(Hypothesis& hypothesis, std::size_t baseline_parameter) {
  for (Unknown& u : hypothesis.unknowns)
    if (u.effect == kBaseline && u.parameter == baseline_parameter) {
      u.prior_std = std::numeric_limits<double>::infinity();
      return;
    }
  hypothesis.unknowns.push_back(baseline_unknown(hypothesis.model, baseline_parameter,
                                                 std::numeric_limits<double>::infinity(), kFreeRange));
}

void add_term_unknowns(Hypothesis& hypothesis, std::size_t term) {
  const Term& added = hypothesis.model.terms[term];
  const std::size_t first = term * kTermUnknowns;
  for (std::size_t i = 0; i < added.parts.size(); ++i) {
    const double now = added.parts[i].coefficient;
    const double scale = now == 0.0 ? 1.0 : std::abs(now);
    hypothesis.unknowns.push_back(
        {.effect = kTerm, .parameter = first + i, .scale = scale, .theta = now / scale});
  }
  const auto add = [&](std::size_t parameter, double value, double range) {
    if (value > 0.0)
      hypothesis.unknowns.push_back({.effect = kTerm,
                                     .parameter = first + parameter,
                                     .logarithmic = true,
                                     .scale = value,
                                     .low = -range,
                                     .high = range});
  };
  add(kTermMemory, added.memory_time, kMemoryRange);
  add(kTermPeriod, added.period, kPeriodRange);
  add(kTermExponent, added.exponent, kExponentRange);
}

void remove_last_term(Hypothesis& hypothesis) {
  hypothesis.model.terms.pop_back();
  const std::size_t removed = hypothesis.model.terms.size();
  std::erase_if(hypothesis.unknowns, [&](const Unknown& u) {
    return u.effect == kTerm && u.parameter / kTermUnknowns == removed;
  });
}

void add_effect(Hypothesis& hypothesis, int effect, const std::vector<double>& start,
                const Evidence& evidence) {
  const LibraryEffect& added = library_effect(effect);
  added.add(hypothesis.model);
  for (std::size_t i = 0; i < added.parameters.size(); ++i) {
    if (added.parameters[i].role == Role::Phase) continue;  // fitted for each run: predict.hpp, in_step
    hypothesis.unknowns.push_back(effect_unknown(effect, i, start[i], evidence));
    write(hypothesis.model, hypothesis.unknowns.back(), hypothesis.unknowns.back().theta);
  }
}

}  // namespace biopsy::sim::gap
