#include "sim/gap/residual/score.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "robot/common/in_parallel.hpp"
#include "sim/gap/fit/fit.hpp"
#include "sim/gap/fit/probes.hpp"
#include "sim/gap/residual/predict.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr int kStrengthTrials = 2;  // until the response is as large as the gap; one more where it diverged
constexpr int kSurfaceTrials = 3;
constexpr double kLeastScale = 0.3, kAsStrong = 0.2;  // of its strength, from trial to trial
constexpr double kMuchTooStrong = 3.0;                // responses within this factor of the gap are used
constexpr double kLargestScale = 3.0;                 // range in which a response is taken as linear

// Projects out of every response what small changes of the present unknowns can explain.
class UnexplainedResidual {
 public:
  UnexplainedResidual(const Hypothesis& current, const Evidence& evidence, std::vector<double> residual_now)
      : now_(std::move(residual_now)) {
    const auto rows = static_cast<Eigen::Index>(now_.size());
    const auto n = static_cast<Eigen::Index>(current.unknowns.size());
    const double root = std::sqrt(residual_weight(evidence, mean_square(now_)));
    Eigen::MatrixXd J = root * sensitivities(current, evidence, now_);
    J_ = J;
    Eigen::MatrixXd information = J.transpose() * J;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double known = current.unknowns[static_cast<std::size_t>(i)].prior_std;
      information(i, i) += std::isfinite(known) ? 1.0 / (known * known) : 1e-9;
    }
    solver_ = information.ldlt();
    gap_ = of(Eigen::Map<const Eigen::VectorXd>(now_.data(), rows));
  }

  Eigen::VectorXd of(const Eigen::VectorXd& response) const {
    if (J_.cols() == 0) return response;
    return response - J_ * solver_.solve(J_.transpose() * response);
  }
  const Eigen::VectorXd& gap() const { return gap_; }
  const std::vector<double>& residual_now() const { return now_; }

 private:
  std::vector<double> now_;
  Eigen::MatrixXd J_;
  Eigen::LDLT<Eigen::MatrixXd> solver_;
  Eigen::VectorXd gap_;
};

// Change of the prediction: -(d residual).
Eigen::VectorXd response(const PlantModel& changed, const Evidence& evidence,
                         const std::vector<double>& now) {
  const std::vector<double> after = residual(changed, evidence, Part::Training);
  const auto rows = static_cast<Eigen::Index>(now.size());
  return Eigen::Map<const Eigen::VectorXd>(now.data(), rows) -
         Eigen::Map<const Eigen::VectorXd>(after.data(), rows);
}

double root_mean_square(const Eigen::VectorXd& v) {
  return v.size() == 0 ? 0.0 : std::sqrt(v.squaredNorm() / static_cast<double>(v.size()));
}

PlantModel with_effect(const Hypothesis& current, int effect, const std::vector<double>& start) {
  PlantModel model = current.model;
  const LibraryEffect& added = library_effect(effect);
  added.add(model);
  for (std::size_t i = 0; i < start.size(); ++i) added.set(model, i, start[i]);
  return model;
}

void scale_strengths(int effect, std::vector<double>& start, double factor) {
  const auto& parameters = library_effect(effect).parameters;
  for (std::size_t i = 0; i < start.size(); ++i)
    if (parameters[i].role == Role::Strength)
      start[i] = std::clamp(start[i] * factor, parameters[i].low, parameters[i].high);
}

bool has_strength(int effect) {
  const auto& parameters = library_effect(effect).parameters;
  return std::any_of(parameters.begin(), parameters.end(),
                     [](const LibraryParameter& p) { return p.role == Role::Strength; });
}

bool may_be_negative(int effect) {
  if (turns_with_sign(library_effect(effect))) return false;
  for (const LibraryParameter& p : library_effect(effect).parameters)
    if (p.role == Role::Strength && !p.is_signed()) return false;
  return true;
}

// Share of the gap's square that the response explains with the best scale, which is returned as well.
double explained(const UnexplainedResidual& remainder, const Eigen::VectorXd& raw, double lowest,
                 double& scale) {
  const Eigen::VectorXd s = remainder.of(raw);
  const double size = s.squaredNorm();
  if (size <= 0.0 || !std::isfinite(size)) return scale = 0.0;
  scale = std::clamp(s.dot(remainder.gap()) / size, lowest, kLargestScale);
  return 1.0 - (remainder.gap() - scale * s).squaredNorm() / remainder.gap().squaredNorm();
}

// Share of the gap's square that the response takes away as it is.
double taken(const UnexplainedResidual& remainder, const Eigen::VectorXd& raw) {
  const Eigen::VectorXd left = remainder.gap() - remainder.of(raw);
  const double share = 1.0 - left.squaredNorm() / remainder.gap().squaredNorm();
  return std::isfinite(share) ? share : 0.0;
}

// A surface gives way or does not: its response is that of the strength, and no multiple of it.
Probe try_surface(const Hypothesis& current, const Evidence& evidence, const UnexplainedResidual& remainder,
                  int effect, std::vector<double> start) {
  Probe best;
  for (int trial = 0; trial < kSurfaceTrials; ++trial) {
    const Eigen::VectorXd raw =
        response(with_effect(current, effect, start), evidence, remainder.residual_now());
    const double share = taken(remainder, raw);
    if (share > best.share || best.start.empty()) best = {start, share};
    double scale = 0.0;
    explained(remainder, raw, kLeastScale, scale);
    if (std::abs(scale - 1.0) < kAsStrong) break;
    scale_strengths(effect, start, std::max(scale, kLeastScale));
  }
  return best;
}

// One probe, its strength first adjusted until the response is about as large as the gap.
Probe try_probe(const Hypothesis& current, const Evidence& evidence, const UnexplainedResidual& remainder,
                int effect, std::vector<double> start) {
  const double wanted = root_mean_square(remainder.gap());
  Probe best;
  int trials = kStrengthTrials;
  for (int trial = 0; trial < trials; ++trial) {
    const Eigen::VectorXd raw =
        response(with_effect(current, effect, start), evidence, remainder.residual_now());
    double scale = 0.0;
    const double share = explained(remainder, raw, may_be_negative(effect) ? -kLargestScale : 0.0, scale);
    if (share > best.share || best.start.empty()) {
      best = {start, share};
      if (has_strength(effect) && scale != 0.0) scale_strengths(effect, best.start, scale);
    }
    const double size = root_mean_square(remainder.of(raw));
    if (!has_strength(effect)) break;
    // Far too strong for a motion so large, the model diverges.
    if (!std::isfinite(size) && trial == 0) ++trials;
    const double factor = !std::isfinite(size) ? 1e-4
                          : size > 0.0         ? std::clamp(wanted / size, 1e-4, 1e4)
                                               : 1e4;
    if (factor < kMuchTooStrong && factor > 1.0 / kMuchTooStrong) break;
    scale_strengths(effect, start, factor);
  }
  return best;
}

Probe try_effect(const Hypothesis& current, const Evidence& evidence, const UnexplainedResidual& remainder,
                 int effect, std::vector<double> start) {
  return gives_way(library_effect(effect))
             ? try_surface(current, evidence, remainder, effect, std::move(start))
             : try_probe(current, evidence, remainder, effect, std::move(start));
}

Probe try_parameter(const Hypothesis& current, const Evidence& evidence, const UnexplainedResidual& remainder,
                    std::size_t number) {
  PlantModel changed = current.model;
  changed.baseline.*(uncertain_baseline(changed.baseline.drive)[number].member) *= 1.02;
  double scale = 0.0;
  const Eigen::VectorXd s = response(changed, evidence, remainder.residual_now());
  // Not projected: the parameter itself is one of the unknowns.
  const Eigen::Map<const Eigen::VectorXd> now(remainder.residual_now().data(), s.size());
  const double size = s.squaredNorm();
  if (size <= 0.0) return {};
  scale = std::clamp(s.dot(now) / size, -25.0, 35.0);
  return {{}, 1.0 - (now - scale * s).squaredNorm() / now.squaredNorm()};
}

}  // namespace

std::string Candidate::name(Drive drive) const {
  return std::string(effect == kBaseline ? uncertain_baseline(drive)[baseline_parameter].name
                                         : library_effect(effect).info.name);
}

std::vector<Candidate> open_candidates(const Hypothesis& current, bool tissue) {
  std::vector<Candidate> out;
  for (std::size_t i = 0; i < library().size(); ++i)
    if (!library()[i].present(current.model) && acts_on(library()[i], current.model.baseline.drive) &&
        (tissue || library()[i].info.attaches != Attachment::Tissue))
      out.push_back({.effect = static_cast<int>(i)});
  const auto& numbers = uncertain_baseline(current.model.baseline.drive);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const bool free = std::any_of(current.unknowns.begin(), current.unknowns.end(), [&](const Unknown& u) {
      return u.effect == kBaseline && u.parameter == i && !std::isfinite(u.prior_std);
    });
    if (!free && numbers[i].candidate && current.model.baseline.*(numbers[i].member) > 0.0)
      out.push_back({.baseline_parameter = i});
  }
  return out;
}

std::vector<Score> score_candidates(const Hypothesis& current, const Evidence& evidence,
                                    const std::vector<Candidate>& candidates) {
  std::vector<double> now = residual(current.model, evidence, Part::Training);
  const Spectrum spectrum = residual_spectrum(now, evidence);
  const UnexplainedResidual remainder(current, evidence, std::move(now));
  struct Task {
    std::size_t candidate;
    std::vector<double> start;
    Probe result = {};
  };
  std::vector<Task> tasks;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i].effect == kBaseline)
      tasks.push_back({i, {}});
    else
      for (auto& start : probe_starts(candidates[i].effect, evidence, spectrum))
        tasks.push_back({i, std::move(start)});
  }
  in_parallel(tasks.size(), [&](std::size_t t) {
    const Candidate& c = candidates[tasks[t].candidate];
    tasks[t].result = c.effect == kBaseline
                          ? try_parameter(current, evidence, remainder, c.baseline_parameter)
                          : try_effect(current, evidence, remainder, c.effect, tasks[t].start);
  });
  std::vector<Score> scores;
  scores.reserve(candidates.size());
  for (const Candidate& c : candidates) scores.push_back({c, {}});
  for (Task& task : tasks) scores[task.candidate].probes.push_back(std::move(task.result));
  for (Score& score : scores)
    std::stable_sort(score.probes.begin(), score.probes.end(),
                     [](const Probe& a, const Probe& b) { return a.share > b.share; });
  std::stable_sort(scores.begin(), scores.end(),
                   [](const Score& a, const Score& b) { return a.share() > b.share(); });
  return scores;
}

}  // namespace biopsy::sim::gap
