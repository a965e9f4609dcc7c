#include "sim/paper/missing/find_missing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "sim/paper/calibration/gradient_steps.hpp"
#include "sim/paper/calibration/leave_one_out.hpp"

namespace biopsy::sim::missing {
namespace {

using calibration::Descent, calibration::Parameter, calibration::Pull, calibration::Question;
using Vector = Eigen::VectorXd;
using RowsMet = std::map<std::string, bool>;  // by figure and quantity

// A calibration without any candidate: where all candidates begin.
struct Base {
  Question question;  // with the figures that are fitted
  Vector z;
  Eigen::MatrixXd even, robust;  // slopes of the residuals there, by their pull
};

Question with(Question question, const Candidate& candidate) {
  for (const auto& [name, value] : candidate.set) calibration::set_value(question.start, name, value);
  question.parameters.insert(question.parameters.end(), candidate.unknowns.begin(), candidate.unknowns.end());
  return question;
}

Vector starts(const std::vector<Parameter>& parameters) {
  Vector z(static_cast<Eigen::Index>(parameters.size()));
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    const Parameter& parameter = parameters[static_cast<std::size_t>(i)];
    z[i] = calibration::to_search(parameter, parameter.start);
  }
  return z;
}

RowsMet rows_met(const Question& question, const Vector& z) {
  RowsMet met;
  for (const PaperRow& row : calibration::rows_at(question, z, true))
    met[row.figure + " " + row.quantity] = row.ok;
  return met;
}

std::size_t count(const RowsMet& rows) {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const auto& row) { return row.second; }));
}

void add_difference(const RowsMet& before, const RowsMet& after, Difference& out) {
  out.met += count(after);
  for (const auto& [row, met] : after) {
    if (met && !before.at(row)) out.won.push_back(row);
    if (!met && before.at(row)) out.lost.push_back(row);
  }
}

// Slopes for two pulls, three descents, and the costs of two ends.
int evaluations_of(const Candidate& candidate, int steps) {
  return 2 * (static_cast<int>(candidate.unknowns.size()) + 1) + 3 * steps * calibration::kEvaluationsAlong +
         2;
}

double cost(const Question& question, const Vector& z) {
  return calibration::residuals(question, z, true, Pull::Robust).squaredNorm();
}

struct Interrupted {};

class Search {
 public:
  Search(const Question& question, const std::vector<Candidate>& candidates, const MissingSettings& settings,
         const calibration::CalibrationProgress& progress)
      : question_(question), candidates_(candidates), settings_(settings), progress_(progress) {
    for (const Candidate& candidate : candidates)
      out_.candidates.push_back({candidate.name, candidate.meaning, {}, {}, {}, 1.0});
    const int unknowns = static_cast<int>(question.parameters.size());
    for (const Candidate& candidate : candidates)
      per_figure_ += evaluations_of(candidate, settings.steps_with);
    per_figure_ += 2 * (unknowns + 1) + evaluations_of({}, settings.steps_with);
    from_nominal_ = 2 * settings.steps * (unknowns + calibration::kEvaluationsAlong);
  }

  MissingInPaper run() {
    const std::vector<std::string> figures = calibration::whole_figures(question_);
    planned_ =
        per_figure_ + from_nominal_ / 2 + static_cast<int>(figures.size()) * (per_figure_ + from_nominal_);
    try {
      fit_all_figures();
      for (const std::string& figure : most_missed_first(figures)) leave_out(figure);
    } catch (const Interrupted&) {
      out_.interrupted = true;
      out_.candidates.resize(tried_);
    }
    for (CandidateResult& result : out_.candidates)
      result.chance = chance_of(result.held_out.won.size(), result.held_out.lost.size());
    std::stable_sort(out_.candidates.begin(), out_.candidates.end(), [](const auto& one, const auto& other) {
      return std::pair(one.held_out.net(), one.fitted.net()) >
             std::pair(other.held_out.net(), other.fitted.net());
    });
    return out_;
  }

 private:
  // Between all that takes seconds.
  void unless_stopped() const {
    if (settings_.stop.stop_requested()) throw Interrupted{};
  }
  void say(const std::string& doing) const {
    if (progress_) progress_(std::min(1.0, static_cast<double>(out_.evaluations) / planned_), doing);
  }

  Base base(Question question, const Vector& z) {
    out_.evaluations += 2 * (static_cast<int>(z.size()) + 1);
    unless_stopped();
    Eigen::MatrixXd even = calibration::slopes(question, z, Pull::Even, 0);
    unless_stopped();
    Eigen::MatrixXd robust = calibration::slopes(question, z, Pull::Robust, 0);
    return {std::move(question), z, std::move(even), std::move(robust)};
  }

  // The candidate's unknowns after those of the base, whose slopes are known. A row that is missed by far
  // pulls at Pull::Even alone; rows that are met may be given up on that way: the better end of both.
  Vector fitted(const Base& base, const Candidate& candidate) {
    const Question question = with(base.question, candidate);
    const auto known = base.z.size(), extra = static_cast<Eigen::Index>(candidate.unknowns.size());
    Vector z(known + extra);
    z << base.z, starts(candidate.unknowns);
    const auto extended = [&](const Eigen::MatrixXd& of_base, Pull pull) {
      Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(of_base.rows() + extra, known + extra);
      slopes.topLeftCorner(of_base.rows(), known) = of_base;
      if (extra > 0) slopes.rightCols(extra) = calibration::slopes(question, z, pull, known);
      return slopes;
    };
    const Eigen::MatrixXd robust = extended(base.robust, Pull::Robust);
    const auto along = [&](const Vector& from, const Eigen::MatrixXd& slopes, Pull pull) {
      unless_stopped();
      return calibration::descend_along(question, from, slopes, settings_.steps_with, pull).z;
    };
    const Vector far = along(along(z, extended(base.even, Pull::Even), Pull::Even), robust, Pull::Robust),
                 near = along(z, robust, Pull::Robust);
    out_.evaluations += evaluations_of(candidate, settings_.steps_with);
    return cost(question, far) < cost(question, near) ? far : near;
  }

  void fit_all_figures() {
    say("all figures");
    const Descent start =
        calibration::descend(question_, starts(question_.parameters), settings_.steps, Pull::Robust,
                             calibration::Differences::Forward, settings_.stop);
    out_.evaluations += start.evaluations;
    const Base from = base(question_, start.z);
    none_ = rows_met(question_, fitted(from, {}));
    out_.rows = none_.size();
    out_.met = count(none_);
    for (const auto& [row, met] : none_)
      if (!met) out_.missed.push_back(row);
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const Candidate& candidate = candidates_[i];
      say("all figures, " + candidate.name);
      const Vector z = fitted(from, candidate);
      add_difference(none_, rows_met(with(question_, candidate), z), out_.candidates[i].fitted);
      for (std::size_t k = 0; k < candidate.unknowns.size(); ++k)
        out_.candidates[i].values.push_back(
            {candidate.unknowns[k].name,
             calibration::from_search(candidate.unknowns[k],
                                      z[from.z.size() + static_cast<Eigen::Index>(k)])});
      for (const auto& [name, value] : candidate.set) out_.candidates[i].values.push_back({name, value});
      tried_ = i + 1;
    }
  }

  std::vector<std::string> most_missed_first(std::vector<std::string> figures) const {
    const auto missed = [&](const std::string& figure) {
      return std::count_if(out_.missed.begin(), out_.missed.end(), [&](const std::string& row) {
        return calibration::whole_figure(row.substr(0, row.find(' '))) == figure;
      });
    };
    std::stable_sort(figures.begin(), figures.end(),
                     [&](const auto& one, const auto& other) { return missed(one) > missed(other); });
    return figures;
  }

  // Counted only once every candidate was tried: otherwise they would be judged by different figures.
  void leave_out(const std::string& figure) {
    const Question rest = calibration::without_figure(question_, figure),
                   alone = calibration::figure_alone(question_, figure);
    say(fmt::format("without figure {}", figure));
    const Descent nominal = calibration::descend_from_nominal(rest, settings_.steps, settings_.stop);
    out_.evaluations += nominal.evaluations;
    const Base from = base(rest, nominal.z);
    const RowsMet without = rows_met(alone, fitted(from, {}));
    std::vector<RowsMet> with_each;
    for (const Candidate& candidate : candidates_) {
      say(fmt::format("without figure {}, {}", figure, candidate.name));
      with_each.push_back(rows_met(with(alone, candidate), fitted(from, candidate)));
    }
    out_.left_out.push_back(figure);
    out_.rows_held_out += without.size();
    out_.met_held_out += count(without);
    for (std::size_t i = 0; i < with_each.size(); ++i)
      add_difference(without, with_each[i], out_.candidates[i].held_out);
  }

  const Question& question_;
  const std::vector<Candidate>& candidates_;
  const MissingSettings& settings_;
  const calibration::CalibrationProgress& progress_;
  int per_figure_ = 0, from_nominal_ = 0, planned_ = 1;  // evaluations
  std::size_t tried_ = 0;                                // candidates that were fitted to all figures
  RowsMet none_;                                         // fitted to all figures
  MissingInPaper out_;
};

}  // namespace

double chance_of(std::size_t won, std::size_t lost) {
  const auto n = static_cast<double>(won + lost);
  double chance = 0.0;
  for (std::size_t k = won; k <= won + lost; ++k) {
    const auto heads = static_cast<double>(k);
    chance += std::exp(std::lgamma(n + 1.0) - std::lgamma(heads + 1.0) - std::lgamma(n - heads + 1.0) -
                       n * std::log(2.0));
  }
  return std::min(1.0, chance);
}

MissingInPaper find_missing(const Question& question, const std::vector<Candidate>& candidates,
                            const MissingSettings& settings,
                            const calibration::CalibrationProgress& progress) {
  return Search(question, candidates, settings, progress).run();
}

}  // namespace biopsy::sim::missing
