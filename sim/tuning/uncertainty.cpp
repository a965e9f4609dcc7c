#include "sim/tuning/uncertainty.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "sim/baseline_entries.hpp"
#include "sim/seeded_noise.hpp"

namespace biopsy::sim::tuning {
namespace {

constexpr double kCut = 2.0;  // standard deviations
constexpr int kAttempts = 100;
constexpr double kAssumed = 0.10;  // of a number whose uncertainty nobody has found out
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

// SI standard deviation of a number; 0 where it is taken as known.
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

// One stage; the names of what was varied go to `varied`.
PlantModel drawn(const NotedModel& model, bool assumed, std::uint64_t seed,
                 std::vector<std::string>& varied) {
  PlantModel stage = model.model;
  std::uint64_t number = 0;
  varied.clear();
  for_each_number(stage, [&](const std::string& name, double& value, double low, double high, double unit) {
    const double z = std::clamp(normals(seed, number++).first, -kCut, kCut);
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
                                 const CanBe& can_be) {
  UncertainStages out;
  out.assumed = knows_none(model.notes);
  for (int i = 0; i < count; ++i)
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const auto which = static_cast<std::uint64_t>(i) * kAttempts + static_cast<std::uint64_t>(attempt);
      const PlantModel stage = drawn(model, out.assumed, hashed(seed, which), out.varied);
      if (can_be && !can_be(stage) && attempt + 1 < kAttempts) {
        ++out.refused;
        continue;
      }
      out.stages.push_back(stage);
      break;
    }
  return out;
}

}  // namespace biopsy::sim::tuning
