#include "sim/paper/calibration/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/paper/calibration/gradient_steps.hpp"
#include "sim/plant/seeded_noise.hpp"

namespace biopsy::sim::calibration {
namespace {

constexpr double kOnlyPrior = 0.9;          // of the prior std, which is 1
constexpr double kStartsSpread = 0.7;       // of the starts around the first, in prior stds
constexpr std::uint64_t kStartDraws = 100;  // counters of their draws

using Vector = Eigen::VectorXd;

CalibratedParameter found(const Parameter& parameter, double z, double std) {
  CalibratedParameter out{parameter, from_search(parameter, z)};
  out.only_prior = std >= kOnlyPrior;
  out.std = parameter.doubt * std * (parameter.share ? 1.0 : out.value);
  out.at_bound = out.value <= parameter.low || out.value >= parameter.high;
  return out;
}

Vector first_guess(const std::vector<Parameter>& parameters) {
  Vector z(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i)
    z[static_cast<Eigen::Index>(i)] = to_search(parameters[i], parameters[i].start);
  return z;
}

std::size_t rows_reached(const Question& question, const Vector& z) {
  const std::vector<PaperRow> rows = rows_at(question, z, true);
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const PaperRow& row) { return row.ok; }));
}

// Start k of several: the first, and draws around it.
Vector start_of(const Question& question, const Vector& first, std::uint64_t seed, int k) {
  Vector z = first;
  if (k > 0)
    for (Eigen::Index i = 0; i < z.size(); ++i)
      z[i] +=
          kStartsSpread *
          normals(seed + kStartDraws * static_cast<std::uint64_t>(k), static_cast<std::uint64_t>(i)).first;
  return within(question.parameters, z);
}

}  // namespace

Calibration calibrate(const Question& question, const CalibrationSettings& settings,
                      const CalibrationProgress& progress) {
  const auto say = [&](double share, const std::string& doing) {
    if (progress) progress(share, doing);
  };
  const auto cost = [&](const Vector& z) { return residuals(question, z, true).squaredNorm(); };
  const Vector first = first_guess(question.parameters);
  Calibration out;
  out.before = cost(first);
  Vector from = first;
  double best = std::numeric_limits<double>::infinity();
  const double far_share = settings.starts > 0 ? 0.7 : 0.0;
  for (int k = 0; k < settings.starts && !settings.stop.stop_requested(); ++k) {
    say(far_share * k / settings.starts, fmt::format("start {} of {}, cost {:.2f} so far", k + 1,
                                                     settings.starts, std::min(best, out.before)));
    const Descent coarse = descend(question, start_of(question, first, settings.seed, k), settings.far_steps,
                                   Pull::Even, Differences::Forward);
    const Descent fine = descend(question, coarse.z, settings.far_steps, Pull::Robust, Differences::Forward);
    out.evaluations += coarse.evaluations + fine.evaluations;
    const double here = cost(fine.z);
    if (here < best) best = here, from = fine.z;
  }
  const CmaResult global =
      minimise([&](const Vector& z) { return residuals(question, z, false).squaredNorm(); }, from,
               {.spread = settings.spread,
                .population = settings.population,
                .evaluations = settings.evaluations,
                .seed = settings.seed,
                .stop = settings.stop},
               [&](double share, double now) {
                 say(far_share + (0.9 - far_share) * share,
                     fmt::format("searching, cost {:.1f} at first, {:.2f} now", out.before, now));
               });
  out.evaluations += global.evaluations;
  // The sum of squares approximates the number of rows met: of the results from both starts, take the one
  // that meets more.
  Vector z = within(question.parameters, global.best);
  std::size_t reached = rows_reached(question, z);
  for (const Vector& begin : {z, within(question.parameters, from)}) {
    if (settings.stop.stop_requested()) break;
    say(0.9, fmt::format("last steps, {} rows met", reached));
    const Descent end = descend(question, begin, settings.last_steps, Pull::Robust, Differences::Central);
    out.evaluations += end.evaluations;
    const std::size_t rows = rows_reached(question, end.z);
    if (rows > reached || (rows == reached && cost(end.z) < cost(z))) z = end.z, reached = rows;
  }
  say(0.97, "standard deviations");
  out.interrupted = settings.stop.stop_requested();
  Vector stds = Vector::Constant(z.size(), std::numeric_limits<double>::quiet_NaN());
  if (!out.interrupted) {
    out.identifiability = identifiability(question.parameters, sensitivities(question, z));
    const Eigen::MatrixXd& C = out.identifiability.covariance;
    stds = C.diagonal().cwiseSqrt();
    out.correlations = stds.cwiseInverse().asDiagonal() * C * stds.cwiseInverse().asDiagonal();
  }
  out.model = turned(question.start, question.parameters, z);
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    out.parameters.push_back(found(question.parameters[i], z[i], stds[i]));
    out.parameters.back().value =
        value_of(out.model, question.parameters[i].name);  // breakaway is at least sliding
  }
  out.rows = rows_at(question, z, true);
  out.runs = run_fits(question, z);
  out.after = cost(z);
  out.kept_start = z == within(question.parameters, first);
  return out;
}

}  // namespace biopsy::sim::calibration
