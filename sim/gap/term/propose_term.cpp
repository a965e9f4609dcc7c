#include "sim/gap/term/propose_term.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "sim/gap/fit/fit.hpp"
#include "sim/gap/millimetres.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/gap/select/compare_candidates.hpp"
#include "sim/gap/select/verdict.hpp"
#include "sim/gap/term/dictionary.hpp"
#include "sim/gap/term/term_fit.hpp"
#include "sim/gap/term/term_meaning.hpp"
#include "sim/term/term_text.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr std::size_t kTermTries = 3;    // of equations that leave as little: the shortest may not stand
constexpr double kTermUndoes = -0.8;     // of the input
constexpr double kTermTolerance = 0.1;   // of the noise
constexpr double kTermClosed = 0.7;      // of the held-out RMSE above the noise, against the given model
constexpr double kTermClosedMore = 0.5;  // and against its calibration
constexpr double kTermInEachRun = 0.5;   // of the excess square that may be left in any one run
constexpr double kTermNeededEvidence = 10.0;
constexpr double kTermLeastExcess = 0.25;     // of the noise's square: less in a run says nothing
constexpr double kTermCalibrationStds = 4.0;  // beyond: it compensates for something

// Unknowns of the term in the order of its parts; then those of its memory, period and exponent.
std::vector<Unknown> term_unknowns(const Hypothesis& hypothesis) {
  std::vector<Unknown> out;
  const std::size_t term = hypothesis.model.terms.size() - 1;
  for (const Unknown& u : hypothesis.unknowns)
    if (u.effect == kTerm && u.parameter / kTermUnknowns == term) out.push_back(u);
  return out;
}

bool distorts_calibration(const Hypothesis& hypothesis) {
  return std::ranges::any_of(hypothesis.unknowns, [](const Unknown& u) {
    return u.effect == kBaseline && std::isfinite(u.prior_std) &&
           std::abs(u.theta - u.prior_mean) > kTermCalibrationStds * u.prior_std;
  });
}

// In each held-out run the term removes most of what the calibration leaves.
bool helps_in_each_run(const ScoredModel& start, const ScoredModel& with, const Evidence& evidence) {
  std::size_t at = 0;
  for (const EvidenceRun& run : evidence.runs) {
    double before = 0.0, after = 0.0;
    const std::size_t rows = run.rows.size() - run.training_rows;
    if (rows == 0) continue;
    for (std::size_t i = 0; i < rows; ++i, ++at) {
      before += start.residual[at] * start.residual[at] / static_cast<double>(rows);
      after += with.residual[at] * with.residual[at] / static_cast<double>(rows);
    }
    const double there = excess(before, evidence);
    if (there < kTermLeastExcess * evidence.noise * evidence.noise) continue;
    if (!(excess(after, evidence) < kTermInEachRun * there)) return false;
  }
  return true;
}

bool is_significant(const ScoredModel& start, const ScoredModel& with, std::size_t coefficients,
                    const Evidence& evidence) {
  const double n = held_out_effective_sample_size(evidence);
  const double tolerated = kTermTolerance * kTermTolerance * evidence.noise * evidence.noise;
  const double gain = 0.5 * n * std::log((start.square + tolerated) / (with.square + tolerated));
  return gain > kTermNeededEvidence + static_cast<double>(coefficients) * (0.5 * std::log(n) + 1.0);
}

// A force that takes away what drives the mechanism is no force that is missing: the recorded input does not
// drive this motion.
bool undoes_the_drive(const Hypothesis& hypothesis) {
  TermPowers drive{};
  drive[static_cast<std::size_t>(TermFactor::Drive)] = 1;
  return hypothesis.model.baseline.drive == Drive::Force &&
         std::ranges::any_of(hypothesis.model.terms.back().parts, [&](const TermPart& part) {
           return part.powers == drive && part.coefficient < kTermUndoes;
         });
}

bool can_be_written(const Hypothesis& hypothesis) {
  const PlantModel& model = hypothesis.model;
  return sim::can_be_written(model.terms.back(), model.baseline.drive == Drive::Stack);
}

bool stands(const ScoredModel& before, const ScoredModel& start, const ScoredModel& with,
            const Evidence& evidence) {
  return std::isfinite(with.square) &&
         gap_closed(before.square, with.square, evidence.noise) >= kTermClosed &&
         gap_closed(start.square, with.square, evidence.noise) >= kTermClosedMore &&
         is_significant(start, with, term_unknowns(with.hypothesis).size(), evidence) &&
         helps_in_each_run(start, with, evidence) &&
         std::ranges::all_of(term_unknowns(with.hypothesis), is_known) &&
         !distorts_calibration(with.hypothesis) && !undoes_the_drive(with.hypothesis) &&
         can_be_written(with.hypothesis);
}

double rounded_outward(double value, bool up) {
  if (value == 0.0) return 0.0;
  const double step = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 1.0);
  return step * (up ? std::ceil(value / step) : std::floor(value / step));
}

// Where the model moved in the recording, of the variables that the term uses.
TermRanges seen_ranges(const Hypothesis& hypothesis, const Evidence& evidence) {
  const TermRanges all = simulated_motion(hypothesis.model, evidence).ranges();
  TermRanges out;
  const bool on_stack = hypothesis.model.baseline.drive == Drive::Stack;
  for (const TermRangeKey& key : range_keys(hypothesis.model.terms.back().parts, on_stack)) {
    const TermRange& range = all.*(key.range);
    out.*(key.range) = {rounded_outward(range.low, false), rounded_outward(range.high, true)};
  }
  return out;
}

std::string free_name(const PlantModel& model) {
  std::string name = "proposed";
  for (int i = 2; std::ranges::any_of(model.terms, [&](const Term& term) { return term.name == name; }); ++i)
    name = fmt::format("proposed_{}", i);
  return name;
}

// Share of each product of the RMS forces over the recording.
std::vector<double> shares_of(const PlantModel& model, const Evidence& evidence) {
  const Term& term = model.terms.back();
  const MotionRows motion = simulated_motion(model, evidence);
  std::vector<double> out;
  double sum = 0.0;
  for (const TermPart& part : term.parts) {
    const std::vector<double> values = values_of(entry_of(part, term), motion);
    out.push_back(std::abs(part.coefficient) * std::sqrt(mean_square(values)));
    sum += out.back();
  }
  for (double& share : out) share = sum > 0.0 ? share / sum : 0.0;
  return out;
}

ProposedTerm describe_term(const ScoredModel& before, const ScoredModel& start, const ScoredModel& with,
                           const Evidence& evidence) {
  const PlantModel& model = with.hypothesis.model;
  const Term& term = model.terms.back();
  const bool on_stack = model.baseline.drive == Drive::Stack;
  const std::vector<Unknown> unknowns = term_unknowns(with.hypothesis);
  const std::vector<double> shares = shares_of(model, evidence);
  ProposedTerm out;
  out.name = term.name;
  out.expression = expression_text(term.parts);
  std::size_t strongest = 0;
  for (std::size_t i = 0; i < term.parts.size(); ++i) {
    const TermPowers& powers = term.parts[i].powers;
    out.coefficients.push_back({.name = coefficient_name(i),
                                .product = product_text(powers),
                                .unit = coefficient_unit(powers, on_stack),
                                .value = term.parts[i].coefficient,
                                .std = unknowns[i].value_std(),
                                .share = shares[i]});
    if (shares[i] > shares[strongest]) strongest = i;
  }
  for (const TermRangeKey& key : range_keys(term.parts, on_stack)) {
    const TermRange& range = term.seen.*(key.range);
    out.seen.push_back({key.variable, key.unit, range.low / key.si_per_unit, range.high / key.si_per_unit});
  }
  for (const Unknown& u : unknowns) {
    const std::size_t number = u.parameter % kTermUnknowns;
    if (number == kTermMemory) out.memory_s = u.value(), out.memory_std = u.value_std();
    if (number == kTermExponent) out.exponent = u.value(), out.exponent_std = u.value_std();
    if (number == kTermPeriod) out.period_mm = u.value() * kMm, out.period_std = u.value_std() * kMm;
  }
  out.rmse_before = std::sqrt(before.square) * kMm;
  out.rmse_calibrated = std::sqrt(start.square) * kMm;
  out.rmse_after = std::sqrt(with.square) * kMm;
  out.gap_closed = gap_closed(before.square, with.square, evidence.noise);
  out.meaning = term_meaning(term.parts[strongest].powers, on_stack);
  return out;
}

}  // namespace

std::optional<TermProposal> propose_term(const ScoredModel& before, const ScoredModel& start,
                                         const Evidence& coarse_rows, const Evidence& fine_rows,
                                         const std::stop_token& stop) {
  if (start.hypothesis.model.terms.size() >= kMostTerms || is_only_noise(start.square, fine_rows) ||
      well_explained(before.square, start.square, fine_rows))
    return std::nullopt;
  Evidence coarse = coarse_rows, fine = fine_rows;
  coarse.work = fine.work = std::make_shared<Work>();
  const std::vector<FittedTerm> found = fitted_terms(start.hypothesis, coarse, stop);
  if (found.empty()) return std::nullopt;
  const double square_now = mean_square(residual(start.hypothesis.model, fine, Part::Training));
  std::size_t tried = 0;
  for (const FittedTerm& one : found) {
    if (!leaves_as_little(one, found.front()) || tried++ == kTermTries) break;
    Hypothesis best = without_unknown_products(converged(one, square_now, fine), square_now, fine).hypothesis;
    best.model.terms.back().seen = seen_ranges(best, fine);
    best.model.terms.back().name = free_name(start.hypothesis.model);
    estimate_uncertainty(best, fine);
    ScoredModel scored = score_model(std::move(best), fine);
    if (!stands(before, start, scored, fine)) continue;
    ProposedTerm description = describe_term(before, start, scored, fine);
    for (const FittedTerm& other : found)
      if (&other != &one && leaves_as_little(other, found.front()))
        description.rivals.push_back(expression_text(other.term().parts));
    return TermProposal{std::move(scored), std::move(description)};
  }
  return std::nullopt;
}

}  // namespace biopsy::sim::gap
