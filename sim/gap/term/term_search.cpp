#include "sim/gap/term/term_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "robot/common/in_parallel.hpp"
#include "sim/gap/fit/fit.hpp"
#include "sim/gap/residual/responses.hpp"
#include "sim/gap/term/sparse_regression.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr std::size_t kLookMostProducts = kMostTermParts;
constexpr double kLookWorthAProduct = 0.7;  // of the excess square, left by one more
constexpr double kLookNearNoise = 0.1;   // of the noise's square: nothing to explain with a further product
constexpr double kLookExplained = 0.05;  // of the excess square, left: enough to look no further
constexpr double kLookAsGood = 3.0;      // ratio of excess squares worth a simulation
constexpr double kLookExact = 0.01;      // of the RMS without a term: the look is linear, the rows are coarse
constexpr std::size_t kLookSuggested = 3;
constexpr std::size_t kLookFolds = 3;  // at least
constexpr double kLookHopedFor = 0.1;  // of the square: the priors' weight is that of a residual so small
constexpr double kLookRoom = 0.2;      // of a range, beyond either end while the term is fitted

// Rows of a training run, or of a piece of one where there are few; held-out rows are not used.
std::vector<int> folds_of(const Evidence& evidence) {
  const auto training = static_cast<std::size_t>(
      std::ranges::count_if(evidence.runs, [](const EvidenceRun& run) { return run.training_rows > 0; }));
  const std::size_t pieces = (kLookFolds + training - 1) / std::max<std::size_t>(1, training);
  std::vector<int> out;
  std::size_t first = 0;
  for (const EvidenceRun& run : evidence.runs) {
    for (std::size_t i = 0; i < run.rows.size(); ++i)
      out.push_back(i < run.training_rows ? static_cast<int>(first + i * pieces / run.training_rows) : -1);
    if (run.training_rows > 0) first += pieces;
  }
  return out;
}

std::vector<std::size_t> calibration_of(const Hypothesis& hypothesis) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < hypothesis.unknowns.size(); ++i)
    if (hypothesis.unknowns[i].effect != kTerm) out.push_back(i);
  return out;
}

double largest_size(const std::vector<double>& values) {
  double out = 0.0;
  for (const double value : values) out = std::max(out, std::abs(value));
  return out;
}

// Of a mechanism's baseline: what a relative error of the number is, as a force in the motion; N, down. The
// answer to it is exact however far the given model is from that motion.
std::vector<double> baseline_force(const Unknown& unknown, const Baseline& b, const MotionRows& motion) {
  const double Baseline::*member = uncertain_baseline(Drive::Force)[unknown.parameter].member;
  std::vector<double> out;
  for (const TermPoint& p : motion.points)
    out.push_back(member == &Baseline::k     ? b.k * p.x
                  : member == &Baseline::c_s ? b.c_s * p.v
                                             : p.drive - b.k * p.x - b.c_s * p.v);
  return out;
}

bool is_force(const Unknown& unknown, const Hypothesis& hypothesis) {
  return unknown.effect == kBaseline && hypothesis.model.baseline.drive == Drive::Force;
}

// Products that a number of the baseline holds already: one that is not known. Of one that is, a product is
// what its error cannot be.
bool is_baseline(const DictionaryEntry& entry, const Hypothesis& around) {
  const auto alone = [&](TermFactor factor) {
    TermPowers powers{};
    powers[static_cast<std::size_t>(factor)] = 1;
    return entry.powers == powers;
  };
  if (around.model.baseline.drive == Drive::Stack) return false;
  return std::ranges::any_of(around.unknowns, [&](const Unknown& u) {
    if (u.effect != kBaseline || std::isfinite(u.prior_std)) return false;
    const double Baseline::*member = uncertain_baseline(Drive::Force)[u.parameter].member;
    return alone(member == &Baseline::k     ? TermFactor::Position
                 : member == &Baseline::c_s ? TermFactor::Speed
                                            : TermFactor::Drive);
  });
}

// The columns of the regression: calibration, then products, each for a largest force of 1 N.
struct Columns {
  Eigen::MatrixXd values;
  std::vector<DictionaryEntry> entries;  // the products
  std::vector<double> per_newton;        // coefficient for that force
  Eigen::VectorXd prior, about;          // of the calibration
};

Columns calibration_columns(const Responses& responses, const Hypothesis& around, const MotionRows& motion,
                            const Evidence& evidence) {
  const std::vector<std::size_t> calibration = calibration_of(around);
  const auto known = static_cast<Eigen::Index>(calibration.size());
  const Eigen::VectorXd now = responses.now();
  Columns out;
  out.values.resize(now.size(), known);
  in_parallel(calibration.size(), [&](std::size_t t) {
    const Unknown& u = around.unknowns[calibration[t]];
    out.values.col(static_cast<Eigen::Index>(t)) =
        is_force(u, around) ? responses.of_force(baseline_force(u, around.model.baseline, motion))
                            : responses.of_unknown(calibration[t]);
  });
  const double weight =
      residual_weight(evidence, kLookHopedFor * now.squaredNorm() / static_cast<double>(now.size()));
  out.prior = out.about = Eigen::VectorXd::Zero(known);
  for (Eigen::Index i = 0; i < known; ++i) {
    const Unknown& u = around.unknowns[calibration[static_cast<std::size_t>(i)]];
    if (!std::isfinite(u.prior_std)) continue;
    out.prior[i] = 1.0 / (weight * u.prior_std * u.prior_std);
    out.about[i] = u.theta - u.prior_mean;  // the solution is the opposite of the change
  }
  return out;
}

void add_products(Columns& out, const std::vector<DictionaryEntry>& entries, const Responses& responses,
                  const MotionRows& motion) {
  const Eigen::Index first = out.values.cols();
  const std::size_t products = out.entries.size();
  out.values.conservativeResize(Eigen::NoChange, first + static_cast<Eigen::Index>(entries.size()));
  out.entries.insert(out.entries.end(), entries.begin(), entries.end());
  out.per_newton.resize(out.entries.size(), 0.0);
  in_parallel(entries.size(), [&](std::size_t t) {
    std::vector<double> down = values_of(entries[t], motion);
    const double size = largest_size(down);
    if (size > 0.0)
      for (double& value : down) value /= -size;
    out.per_newton[products + t] = size > 0.0 ? 1.0 / size : 0.0;
    out.values.col(first + static_cast<Eigen::Index>(t)) = responses.of_force(down);
  });
}

// What the residual would be without the term that the model ends with.
Eigen::VectorXd without_term(Eigen::VectorXd residual, const Term& term, const Responses& responses,
                             const MotionRows& motion) {
  for (const TermPart& part : term.parts) {
    std::vector<double> down = values_of(entry_of(part, term), motion);
    for (double& value : down) value *= -part.coefficient;
    residual -= responses.of_force(down);
  }
  return residual;
}

// One time of memory and one period in a term, and no product twice.
bool may_join(const std::vector<DictionaryEntry>& entries, const Support& support, std::size_t column) {
  const DictionaryEntry& added = entries[column];
  return std::ranges::none_of(support, [&](std::size_t i) {
    const auto two = [&](double DictionaryEntry::*number) {
      return added.*number > 0.0 && entries[i].*number > 0.0 && added.*number != entries[i].*number;
    };
    return two(&DictionaryEntry::memory_time) || two(&DictionaryEntry::period) ||
           entries[i].powers == added.powers;
  });
}

// The residual is to vanish, and the columns' sum is its opposite: so are coefficients and changes of the
// calibration.
Hypothesis suggestion(Hypothesis around, bool with_term, const Support& support,
                      const Eigen::VectorXd& solution, const Columns& columns, const MotionRows& motion) {
  if (with_term) remove_last_term(around);
  const Eigen::Index known = columns.prior.size();
  std::vector<double> thetas;
  Eigen::Index next = 0;
  for (const Unknown& u : around.unknowns)
    thetas.push_back(u.effect == kTerm ? u.theta : std::clamp(u.theta - solution[next++], u.low, u.high));
  around.set(thetas);
  Term term;
  for (std::size_t i = 0; i < support.size(); ++i) {
    const DictionaryEntry& entry = columns.entries[support[i]];
    term.parts.push_back(
        {.coefficient = -solution[known + static_cast<Eigen::Index>(i)] * columns.per_newton[support[i]],
         .powers = entry.powers});
    term.memory_time = std::max(term.memory_time, entry.memory_time);
    term.period = std::max(term.period, entry.period);
    term.exponent = std::max(term.exponent, entry.exponent);
  }
  term.seen = motion.ranges();
  for (TermRange* range : {&term.seen.x, &term.seen.v, &term.seen.drive, &term.seen.memory}) {
    const double room = kLookRoom * (range->high - range->low);
    range->low -= room, range->high += room;
  }
  around.model.terms.push_back(std::move(term));
  add_term_unknowns(around, around.model.terms.size() - 1);
  return around;
}

// How many products: fewer where one more leaves nearly as much. left(i): by i + 1 products.
std::size_t worthwhile(std::size_t most, const std::function<double(std::size_t)>& left) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < most; ++i)
    if (left(i) < std::pow(kLookWorthAProduct, static_cast<double>(i - best)) * left(best)) best = i;
  return best;
}

}  // namespace

double term_tolerance(double before, const Evidence& evidence) {
  return std::max(kLookNearNoise * evidence.noise * evidence.noise, kLookExact * kLookExact * before);
}

std::vector<Hypothesis> suggested_terms(const Hypothesis& around, bool with_term, const MotionRows& motion,
                                        const Evidence& evidence) {
  std::vector<DictionaryEntry> entries = distinct_entries(motion);
  std::erase_if(entries, [&](const DictionaryEntry& entry) { return is_baseline(entry, around); });
  const auto repeating = std::stable_partition(
      entries.begin(), entries.end(), [](const DictionaryEntry& entry) { return entry.period == 0.0; });
  const std::vector<DictionaryEntry> waves(repeating, entries.end());
  entries.erase(repeating, entries.end());
  const Responses responses(around, evidence);
  Eigen::VectorXd target = responses.now();
  if (!target.allFinite()) return {};
  Columns columns = calibration_columns(responses, around, motion, evidence);
  const auto known = static_cast<std::size_t>(columns.prior.size());
  if (with_term) target = without_term(target, around.model.terms.back(), responses, motion);
  if (!target.allFinite()) return {};
  std::vector<std::vector<ScoredSupport>> by_size;
  std::optional<SparseRegression> regression;
  const auto look = [&](const std::vector<DictionaryEntry>& more) {
    add_products(columns, more, responses, motion);
    regression.emplace(columns.values, target, known, columns.prior, columns.about, folds_of(evidence));
    by_size = regression->search(kLookMostProducts, [&](const Support& support, std::size_t column) {
      return may_join(columns.entries, support, column);
    });
  };
  look(entries);
  if (by_size.empty()) return {};
  const double tolerated = term_tolerance(regression->cross_validated({}), evidence);
  const auto left = [&](std::size_t size) {
    return excess(by_size[size].front().square, evidence) + tolerated;
  };
  // What repeats along the way is looked for where nothing simpler explains the residual: its many periods
  // cost as much as all else.
  std::size_t size = worthwhile(by_size.size(), left);
  if (left(size) > kLookExplained * excess(regression->cross_validated({}), evidence)) {
    look(waves);
    size = worthwhile(by_size.size(), left);
  }
  std::vector<Hypothesis> out;
  const double best = left(size);
  const auto add = [&](const Support& support) {
    out.push_back(suggestion(around, with_term, support, regression->solve(support), columns, motion));
  };
  for (const ScoredSupport& one : by_size[size])
    if (out.size() < kLookSuggested && excess(one.square, evidence) + tolerated < kLookAsGood * best)
      add(one.columns);
  if (size > 0) add(by_size[size - 1].front().columns);
  return out;
}

}  // namespace biopsy::sim::gap
