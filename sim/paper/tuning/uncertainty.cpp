#include "sim/paper/tuning/uncertainty.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <map>

#include "sim/plant/baseline_entries.hpp"
#include "sim/plant/seeded_noise.hpp"

namespace biopsy::sim::tuning {
namespace {

constexpr double kCut = 2.0;  // standard deviations
constexpr int kAttempts = 100;
constexpr std::uint64_t kTogether = 1'000;  // counter of the correlated draws
constexpr double kAssumed = 0.10;           // relative std where the file has none
constexpr std::array kShapingTheLoop{"eps_film", "V0", "tau_h", "k", "c_s"};

// Calls visit(name, number, low, high, si_per_unit) for each number of the model that a file can hold.
template <class Visit>
void for_each_number(PlantModel& model, Visit&& visit) {
  for (const BaselineEntry& entry : baseline_entries())
    if (entry.acts_in(model.baseline.drive))
      visit(std::string(entry.name), model.baseline.*(entry.member), entry.low, entry.high, 1.0);
  for_each_effect(model.effects, [&](auto& slot) {
    if (!slot) return;
    using Effect = typename std::decay_t<decltype(slot)>::value_type;
    for (const auto& p : Effect::parameters())
      visit(fmt::format("{}.{}", Effect::info.name, p.name), (*slot).*(p.member), p.low * p.si_per_unit,
            p.high * p.si_per_unit, p.si_per_unit);
  });
}

// SI standard deviation of a parameter; 0 where it is taken as known.
double deviation(const ModelNotes& notes, bool assumed, const std::string& name, double value,
                 double si_per_unit) {
  if (assumed) {
    const bool shapes =
        std::find(kShapingTheLoop.begin(), kShapingTheLoop.end(), name) != kShapingTheLoop.end();
    return shapes ? kAssumed * value : 0.0;
  }
  const auto note = notes.values.find(name);
  return note != notes.values.end() && note->second.std ? *note->second.std * si_per_unit : 0.0;
}

bool knows_none(const ModelNotes& notes) {
  return std::none_of(notes.values.begin(), notes.values.end(),
                      [](const auto& entry) { return entry.second.std.value_or(0.0) > 0.0; });
}

// A with A A^T = the correlations; eigenvalues that rounding made negative are set to 0.
Eigen::MatrixXd root_of(const Correlations& correlations) {
  const auto n = static_cast<Eigen::Index>(correlations.values.size());
  Eigen::MatrixXd C(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      C(i, j) = correlations.between(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(C);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

// Standard normals by name, correlated.
std::map<std::string, double> normals_of(const std::optional<Correlations>& correlations,
                                         std::uint64_t seed) {
  std::map<std::string, double> z;
  if (!correlations) return z;
  Eigen::VectorXd alone(static_cast<Eigen::Index>(correlations->values.size()));
  for (Eigen::Index i = 0; i < alone.size(); ++i)
    alone[i] = normals(seed, kTogether + static_cast<std::uint64_t>(i)).first;
  const Eigen::VectorXd together = root_of(*correlations) * alone;
  for (Eigen::Index i = 0; i < alone.size(); ++i)
    z[correlations->values[static_cast<std::size_t>(i)]] = together[i];
  return z;
}

// One stage; `varied` gets the names of the varied parameters.
PlantModel drawn(const NotedModel& model, bool assumed, std::uint64_t seed,
                 std::vector<std::string>& varied) {
  PlantModel stage = model.model;
  std::uint64_t number = 0;
  varied.clear();
  const std::map<std::string, double> together = normals_of(model.notes.correlations, seed);
  for_each_number(stage, [&](const std::string& name, double& value, double low, double high, double unit) {
    const auto found = together.find(name);
    const double own = normals(seed, number++).first;
    const double z = std::clamp(found != together.end() ? found->second : own, -kCut, kCut);
    const double std = deviation(model.notes, assumed, name, value, unit);
    if (std <= 0.0) return;
    value = std::clamp(value + z * std, low, high);
    varied.push_back(name);
  });
  stage.noise_seed = seed;
  return stage;
}

}  // namespace

UncertainStages uncertain_stages(const NotedModel& model, int count, std::uint64_t seed,
                                 const IsPlausible& is_plausible) {
  UncertainStages out;
  out.assumed = knows_none(model.notes);
  for (int i = 0; i < count; ++i)
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const auto which = static_cast<std::uint64_t>(i) * kAttempts + static_cast<std::uint64_t>(attempt);
      const PlantModel stage = drawn(model, out.assumed, hashed(seed, which), out.varied);
      if (is_plausible && !is_plausible(stage) && attempt + 1 < kAttempts) {
        ++out.refused;
        continue;
      }
      out.stages.push_back(stage);
      break;
    }
  return out;
}

}  // namespace biopsy::sim::tuning
