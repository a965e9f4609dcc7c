#include "sim/gap/term/term_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robot/common/in_parallel.hpp"
#include "sim/gap/fit/fit.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/gap/select/verdict.hpp"
#include "sim/gap/term/term_search.hpp"
#include "sim/term/term_text.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr int kTermQuickIterations = 12, kTermFineIterations = 20;
constexpr int kTermAttempts = 3;  // for one equation, each with coefficients times kTermWeaker
constexpr double kTermWeaker = 0.3;
constexpr double kTermKnown = 0.5;  // standard deviation of a coefficient, of itself
constexpr int kTermLooks = 2;
constexpr double kTermAsGood = 1.5;  // ratio of excess squares within which the shorter equation is taken
constexpr const char* kDryFrictions =
    "a sign(v) + b x sign(v) + c x^2 sign(v) + d |u| sign(v) + e u^2 sign(v)";
constexpr double kTermSeed = 0.1;  // of the term's largest force, at which a product begins to be fitted
constexpr double kTermWorthAProduct = 0.7;            // of the excess square, left by one more
constexpr std::uint64_t kTermMostWork = 120'000'000;  // steps

FittedTerm fitted(Hypothesis hypothesis, const Evidence& evidence, int iterations, double tolerated,
                  double trust = 1.0) {
  fit(hypothesis, evidence, iterations, trust);
  FittedTerm out{.hypothesis = std::move(hypothesis)};
  const double square = mean_square(residual(out.hypothesis.model, evidence, Part::Training));
  if (std::isfinite(square)) out.square = square, out.excess = excess(square, evidence) + tolerated;
  return out;
}

// A start that ends worse than no term was too strong.
FittedTerm fit_term(const Hypothesis& suggested, double square_now, double tolerated,
                    const Evidence& evidence) {
  FittedTerm best;
  Hypothesis start = suggested;
  for (int attempt = 0; attempt < kTermAttempts; ++attempt) {
    FittedTerm now = fitted(start, evidence, kTermQuickIterations, tolerated);
    if (attempt == 0 || now.square < best.square) best = std::move(now);
    if (best.square < square_now) break;
    std::vector<double> thetas;
    for (const Unknown& u : start.unknowns)
      thetas.push_back(u.effect == kTerm && !u.logarithmic ? kTermWeaker * u.theta : u.theta);
    start.set(thetas);
  }
  return best;
}

void sort_by_merit(std::vector<FittedTerm>& all) {
  if (all.empty()) return;
  const FittedTerm least = *std::ranges::min_element(all, {}, &FittedTerm::excess);
  std::ranges::stable_sort(all, [&](const FittedTerm& a, const FittedTerm& b) {
    const bool good = leaves_as_little(a, least);
    if (good != leaves_as_little(b, least)) return good;
    if (good && a.term().parts.size() != b.term().parts.size())
      return a.term().parts.size() < b.term().parts.size();
    return a.square < b.square;
  });
}

// Without its i-th product, from the numbers that were reached.
Hypothesis without_part(Hypothesis hypothesis, std::size_t i) {
  Term term = hypothesis.model.terms.back();
  remove_last_term(hypothesis);
  term.parts.erase(term.parts.begin() + static_cast<std::ptrdiff_t>(i));
  const bool memory = std::ranges::any_of(
      term.parts, [](const TermPart& part) { return power_of(part.powers, TermFactor::Memory) > 0; });
  if (!memory) term.memory_time = 0.0;
  if (!has_period(term.parts)) term.period = 0.0;
  if (!has_exponent(term.parts)) term.exponent = 0.0;
  hypothesis.model.terms.push_back(std::move(term));
  add_term_unknowns(hypothesis, hypothesis.model.terms.size() - 1);
  return hypothesis;
}

FittedTerm pruned(FittedTerm one, double tolerated, const Evidence& evidence) {
  for (std::size_t i = 0; i < one.term().parts.size() && one.term().parts.size() > 1;) {
    FittedTerm shorter = fitted(without_part(one.hypothesis, i), evidence, kTermQuickIterations, tolerated);
    if (leaves_as_little(shorter, one))
      one = std::move(shorter), i = 0;
    else
      ++i;
  }
  return one;
}

// With a further product, of a tenth of the force that it has.
Hypothesis with_part(Hypothesis hypothesis, const TermPowers& powers) {
  Term term = hypothesis.model.terms.back();
  remove_last_term(hypothesis);
  Term alone = term;
  alone.parts = {{.coefficient = 1.0, .powers = powers}};
  if (const double unit = alone.largest_force(); unit > 0.0)
    term.parts.push_back({.coefficient = -kTermSeed * term.largest_force() / unit, .powers = powers});
  hypothesis.model.terms.push_back(std::move(term));
  add_term_unknowns(hypothesis, hypothesis.model.terms.size() - 1);
  return hypothesis;
}

// The answer to a small force does not tell one dry friction from another, for a plate that stands does not
// answer: each is tried beside those that were found.
FittedTerm with_dry_friction(FittedTerm one, double tolerated, const Evidence& evidence) {
  const std::vector<TermPart> frictions = parse_expression(kDryFrictions, "");
  while (one.term().has_dry_friction() && one.term().parts.size() < kMostTermParts) {
    std::vector<FittedTerm> more(frictions.size(), one);
    in_parallel(frictions.size(), [&](std::size_t i) {
      const bool known = std::ranges::any_of(
          one.term().parts, [&](const TermPart& part) { return part.powers == frictions[i].powers; });
      if (!known)
        more[i] =
            fitted(with_part(one.hypothesis, frictions[i].powers), evidence, kTermQuickIterations, tolerated);
    });
    FittedTerm& best = *std::ranges::min_element(more, {}, &FittedTerm::excess);
    if (!(best.excess < kTermWorthAProduct * one.excess)) return one;
    one = std::move(best);
  }
  return one;
}

// Numbers with a prior at its mean: what a wrong model made of them is no start.
Hypothesis uncalibrated(Hypothesis hypothesis) {
  std::vector<double> thetas;
  for (const Unknown& u : hypothesis.unknowns)
    thetas.push_back(std::isfinite(u.prior_std) ? u.prior_mean : u.theta);
  hypothesis.set(thetas);
  return hypothesis;
}

}  // namespace

bool leaves_as_little(const FittedTerm& one, const FittedTerm& other) {
  return one.excess < kTermAsGood * other.excess;
}

std::vector<FittedTerm> fitted_terms(const Hypothesis& start, const Evidence& coarse,
                                     const std::stop_token& stop) {
  const Hypothesis given = uncalibrated(start);
  const double square_now = mean_square(residual(start.model, coarse, Part::Training));
  const double tolerated = term_tolerance(square_now, coarse);
  const auto is_over = [&] { return stop.stop_requested() || coarse.work->steps > kTermMostWork; };
  std::vector<FittedTerm> out;
  for (int look = 0; look < kTermLooks && !is_over(); ++look) {
    const bool again = !out.empty();
    if (look > 0 && !again) break;
    const Hypothesis& around = again ? out.front().hypothesis : given;
    const MotionRows motion =
        again ? simulated_motion(around.model, coarse) : measured_motion(around.model, coarse);
    const std::vector<Hypothesis> suggested = suggested_terms(around, again, motion, coarse);
    std::vector<FittedTerm> now(suggested.size());
    in_parallel(suggested.size(),
                [&](std::size_t i) { now[i] = fit_term(suggested[i], square_now, tolerated, coarse); });
    for (FittedTerm& one : now)
      if (one.square < square_now) out.push_back(std::move(one));
    sort_by_merit(out);
  }
  if (stop.stop_requested()) return {};
  if (!out.empty() && !is_over()) out.front() = with_dry_friction(std::move(out.front()), tolerated, coarse);
  if (!out.empty() && !is_over()) out.front() = pruned(std::move(out.front()), tolerated, coarse);
  return out;
}

bool is_known(const Unknown& unknown) {
  return unknown.logarithmic ? unknown.std < 1.0
                             : unknown.value_std() < kTermKnown * std::abs(unknown.value());
}

FittedTerm without_unknown_products(FittedTerm term, double square_before, const Evidence& fine) {
  for (;;) {
    estimate_uncertainty(term.hypothesis, fine);
    const std::size_t parts = term.term().parts.size();
    if (parts < 2) return term;
    const Unknown* worst = nullptr;
    std::size_t part = 0;
    for (const Unknown& u : term.hypothesis.unknowns) {
      if (u.effect != kTerm || u.parameter / kTermUnknowns + 1 != term.hypothesis.model.terms.size() ||
          u.parameter % kTermUnknowns >= parts || is_known(u))
        continue;
      if (worst == nullptr || u.std > worst->std) worst = &u, part = u.parameter % kTermUnknowns;
    }
    if (worst == nullptr) return term;
    term = converged({.hypothesis = without_part(term.hypothesis, part)}, square_before, fine);
  }
}

FittedTerm converged(const FittedTerm& term, double square_before, const Evidence& fine) {
  FittedTerm out = fitted(term.hypothesis, fine, kTermFineIterations, 0.0);
  if (!well_explained(square_before, out.square, fine)) return out;
  FittedTerm trusting = fitted(out.hypothesis, fine, kTermFineIterations, 0.0, kTrustReadings);
  return trusting.square <= out.square ? trusting : out;
}

}  // namespace biopsy::sim::gap
