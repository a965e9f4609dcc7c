#include "tests/bench/gap_peers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "robot/common/in_parallel.hpp"
#include "robot/common/statistics.hpp"
#include "sim/gap/fit/fit.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/gap/residual/score.hpp"

namespace biopsy::bench {
namespace {

using sim::Drive;
using sim::gap::Evidence;
using sim::gap::Hypothesis;

constexpr double kMm = 1e3;
constexpr int kIterations = 25;
constexpr double kHelps = 0.95;   // held-out RMSE after over before
constexpr std::size_t kFits = 6;  // of each round, the most promising by the score test
constexpr int kMostEffects = 3, kMostRounds = 5;

double training_square(const Hypothesis& hypothesis, const Evidence& evidence) {
  return sim::gap::mean_square(residual(hypothesis.model, evidence, sim::gap::Part::Training));
}

std::vector<std::string> baseline_numbers(const sim::PlantModel& model) {
  std::vector<std::string> names;
  for (const auto& number : sim::gap::uncertain_baseline(model.baseline.drive))
    if (number.candidate && model.baseline.*(number.member) > 0.0) names.emplace_back(number.name);
  return names;
}

// Every reading counts for one, as the textbook has it. A simulation that diverged is worse than any other.
double textbook_bic(const Hypothesis& hypothesis, const Evidence& evidence, double readings) {
  const double bic = readings * std::log(training_square(hypothesis, evidence)) + hypothesis.prior_cost() +
                     static_cast<double>(hypothesis.unknowns.size()) * std::log(readings);
  return std::isfinite(bic) ? bic : std::numeric_limits<double>::infinity();
}

double training_readings(const sim::Dataset& data, const Evidence& evidence) {
  double out = 0.0;
  for (std::size_t i = 0; i < data.runs.size(); ++i)
    out += static_cast<double>(data.runs[i].time.size()) *
           static_cast<double>(evidence.runs[i].training_rows) /
           static_cast<double>(evidence.runs[i].rows.size());
  return out;
}

struct Attempt {
  sim::gap::Candidate candidate;
  Hypothesis hypothesis;
  double bic = 0.0;
};

// The round's most promising candidates, fitted; the least criterion first.
std::vector<Attempt> attempts(const Hypothesis& current, const Evidence& evidence, double readings) {
  const auto scores = score_candidates(current, evidence, open_candidates(current, evidence.tissue));
  std::vector<Attempt> out(std::min(kFits, scores.size()));
  in_parallel(out.size(), [&](std::size_t i) {
    Attempt& one = out[i];
    one.candidate = scores[i].candidate;
    one.hypothesis = current;
    if (one.candidate.effect == sim::gap::kBaseline)
      free_parameter(one.hypothesis, one.candidate.baseline_parameter);
    else
      add_effect(one.hypothesis, one.candidate.effect, scores[i].probes.front().start, evidence);
    fit(one.hypothesis, evidence, kIterations);
    one.bic = textbook_bic(one.hypothesis, evidence, readings);
  });
  std::ranges::sort(out, {}, &Attempt::bic);
  return out;
}

hidden::AnsweredEffect answered(const Hypothesis& hypothesis, int effect, double probability) {
  const auto& entry = sim::gap::library_effect(effect);
  hidden::AnsweredEffect out{std::string(entry.info.name), probability, {}, {}};
  for (const auto& unknown : hypothesis.unknowns)
    if (unknown.effect == effect) {
      const auto& p = entry.parameters[unknown.parameter];
      const double per_theta = unknown.logarithmic ? std::abs(unknown.value()) : unknown.scale;
      out.parameters.push_back(
          {std::string(p.name), unknown.value() / p.si_per_unit, per_theta * unknown.std / p.si_per_unit});
    }
  return out;
}

double best_weight(const std::vector<Attempt>& tried) {
  double sum = 0.0;
  for (const Attempt& one : tried) sum += std::exp(-0.5 * (one.bic - tried.front().bic));
  return 1.0 / sum;
}

}  // namespace

void mark(hidden::Answer& answer, const sim::PlantModel& before, const sim::PlantModel& after,
          const Evidence& evidence) {
  const auto rmse = [&](const sim::PlantModel& model) {
    return kMm * std::sqrt(sim::gap::mean_square(residual(model, evidence, sim::gap::Part::HeldOut)));
  };
  answer.rmse_before = rmse(before);
  answer.rmse_after = rmse(after);
  answer.noise = kMm * evidence.noise;
  const double gap = answer.rmse_before - answer.noise;
  answer.gap_closed = gap > 0.0 ? (answer.rmse_before - answer.rmse_after) / gap : 0.0;
}

hidden::Answer fit_all_parameters(const sim::Dataset& data, const sim::PlantModel& model) {
  const Evidence evidence = sim::gap::prepare(data, model, {}, sim::gap::Sampling::Fine);
  Hypothesis all = sim::gap::baseline_hypothesis(model, baseline_numbers(model));
  fit(all, evidence, kIterations);
  estimate_uncertainty(all, evidence);
  hidden::Answer answer;
  mark(answer, model, all.model, evidence);
  const bool helps = answer.rmse_after < kHelps * answer.rmse_before;
  answer.verdict = helps ? "parameter" : "no_gap";
  if (!helps) mark(answer, model, model, evidence);
  for (const auto& unknown : all.unknowns)
    if (helps && std::abs(unknown.theta) > kTwoSided95 * unknown.std)
      answer.parameters_changed.emplace_back(
          sim::gap::uncertain_baseline(model.baseline.drive)[unknown.parameter].name);
  return answer;
}

hidden::Answer select_naively(const sim::Dataset& data, const sim::PlantModel& model) {
  const Evidence evidence = sim::gap::prepare(data, model, {}, sim::gap::Sampling::Coarse);
  const double readings = training_readings(data, evidence);
  Hypothesis best = sim::gap::baseline_hypothesis(model, {});
  fit(best, evidence, kIterations);
  double bic = textbook_bic(best, evidence, readings);
  hidden::Answer answer;
  std::vector<std::pair<int, double>> effects;
  for (int round = 1; round <= kMostRounds && effects.size() < kMostEffects; ++round) {
    const auto tried = attempts(best, evidence, readings);
    if (tried.empty() || !(tried.front().bic < bic)) break;
    best = tried.front().hypothesis, bic = tried.front().bic;
    const auto& entered = tried.front().candidate;
    if (entered.effect == sim::gap::kBaseline)
      answer.parameters_changed.push_back(entered.name(model.baseline.drive));
    else
      effects.emplace_back(entered.effect, best_weight(tried));
  }
  estimate_uncertainty(best, evidence);  // kinder than the textbook's, which takes errors as independent
  for (const auto& [effect, weight] : effects) answer.effects.push_back(answered(best, effect, weight));
  answer.verdict = !effects.empty() ? "effect" : !answer.parameters_changed.empty() ? "parameter" : "no_gap";
  mark(answer, model, best.model, evidence);
  return answer;
}

}  // namespace biopsy::bench
