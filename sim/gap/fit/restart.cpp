#include "sim/gap/fit/restart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "robot/common/in_parallel.hpp"
#include "sim/gap/fit/fit.hpp"
#include "sim/gap/residual/predict.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr int kRestartIterations = 8;
constexpr double kRestartConverged = 1e-2;  // of the cost: the best is fitted on
constexpr int kRounds = 2;                  // of moves from the best so far
constexpr double kFactor = 1.4;             // ln: four times as much or little
constexpr double kElsewhere = 0.07;         // of the range of motion, or of the largest voltage
constexpr double kStronger = 2.5;           // times, and as much weaker
constexpr double kBetter = 0.98;            // of the mean square

Role role_of(const Unknown& u) {
  return library_effect(u.effect).parameters[u.parameter].role;
}

// Where else a number may be; its theta.
std::vector<double> elsewhere(const Unknown& u) {
  const Role role = role_of(u);
  double apart = 0.0;
  if (role == Role::Shape) apart = u.logarithmic ? kFactor : 0.5 * (u.high - u.low);
  if (role == Role::Place || role == Role::Level) apart = kElsewhere;
  std::vector<double> out;
  if (apart == 0.0) return out;
  for (const double theta : {u.theta - apart, u.theta + apart})
    if (const double at = std::clamp(theta, u.low, u.high); at != u.theta) out.push_back(at);
  return out;
}

// A spring that stiffens shifts the resonance: between two strengths the model is in step with a part of the
// measured ringing.
std::vector<double> other_strengths(const Unknown& u) {
  return {std::clamp(u.theta / kStronger, u.low, u.high), std::clamp(u.theta * kStronger, u.low, u.high)};
}

// One number elsewhere; or a place and a shape, one up and the other down: what begins earlier and lasts
// longer may end where it did.
std::vector<Hypothesis> elsewhere(const Hypothesis& best) {
  std::vector<Hypothesis> out;
  const auto move = [&](std::size_t i, double to_i, std::size_t j, double to_j) {
    std::vector<double> thetas;
    for (const Unknown& u : best.unknowns) thetas.push_back(u.theta);
    thetas[i] = to_i, thetas[j] = to_j;
    out.push_back(best);
    out.back().set(thetas);
  };
  const auto& all = best.unknowns;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (const double theta : all.size() == 1 ? other_strengths(all[i]) : elsewhere(all[i])) {
      move(i, theta, i, theta);
      if (role_of(all[i]) != Role::Place) continue;
      for (std::size_t j = 0; j < all.size(); ++j)
        for (const double other : elsewhere(all[j]))
          if (role_of(all[j]) == Role::Shape && (other > all[j].theta) != (theta > all[i].theta))
            move(i, theta, j, other);
    }
  return out;
}

double training_square(const PlantModel& model, const Evidence& evidence) {
  const double square = mean_square(residual(model, evidence, Part::Training));
  return std::isfinite(square) ? square : std::numeric_limits<double>::infinity();
}

}  // namespace

Hypothesis restarted(const Hypothesis& fitted, int effect, const Evidence& evidence) {
  Hypothesis best{.model = fitted.model, .unknowns = {}};
  for (const Unknown& u : fitted.unknowns)
    if (u.effect == effect) best.unknowns.push_back(u);
  double least = training_square(best.model, evidence);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Hypothesis> moved = elsewhere(best);
    std::vector<double> squares(moved.size());
    in_parallel(moved.size(), [&](std::size_t i) {
      const double square = fit(moved[i], evidence, kRestartIterations, 1.0, kRestartConverged);
      squares[i] = std::isfinite(square) ? square : std::numeric_limits<double>::infinity();
    });
    const auto first = std::ranges::min_element(squares);
    if (first == squares.end() || !(*first < kBetter * least)) break;
    least = *first;
    best = moved[static_cast<std::size_t>(first - squares.begin())];
  }
  Hypothesis out = fitted;
  out.model = best.model;
  for (Unknown& u : out.unknowns)
    for (const Unknown& reached : best.unknowns)
      if (u.effect == reached.effect && u.parameter == reached.parameter) u = reached;
  return out;
}

}  // namespace biopsy::sim::gap
