// Models, inputs and runs that several tests share.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <type_traits>
#include <vector>

#include "robot/msg/plan.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/plant/plant.hpp"
#include "sim/tissue/tissue.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim {

inline std::filesystem::path models_folder() {
  return source_dir() / "sim" / "models";
}

// The paper's needle experiment: muscle 2 mm, gap 0.9 mm, liver behind.
inline std::vector<Layer> paper_layers() {
  return {{"muscle", Millimetres(0), Millimetres(2)},
          {"gap", Millimetres(2), Millimetres(2.9)},
          {"liver", Millimetres(2.9), Millimetres(20)}};
}

inline PlantModel rehearsal_with_tissue() {
  PlantModel model = read_model(models_folder() / "rehearsal.toml");
  model.tissue = tissue_along(paper_layers(), read_tissues(models_folder() / "tissues.toml"));
  return model;
}

// A mass with a measured force on it: shows a single effect.
inline PlantModel bare_mass(double damping = 0.0, double spring = 0.0) {
  PlantModel model;
  model.baseline.drive = Drive::Force;
  model.baseline.m = 0.080;
  model.baseline.c_s = damping;
  model.baseline.k = spring;
  return model;
}

// Twenty seconds of up, hold, down, up higher, down, polarity flipping at 2 Hz. V at millisecond k
inline double ramps_and_flips(int k) {
  const double t = k * 1e-3;
  const double amplitude = t < 4    ? 750.0 * t
                           : t < 8  ? 3000.0
                           : t < 12 ? 3000.0 - 500.0 * (t - 8)
                           : t < 16 ? 1000.0 + 1000.0 * (t - 12)
                                    : 5000.0 - 1250.0 * (t - 16);
  return (k / 250) % 2 == 0 ? amplitude : -amplitude;
}

// The state after constant inputs over whole milliseconds.
inline PlantState held(const PlantModel& model, PlantState state, const PlantInputs& inputs,
                       int milliseconds) {
  for (int k = 0; k < milliseconds; ++k) state = step(model, state, inputs, Seconds(1e-3));
  return state;
}
inline PlantState pushed(const PlantModel& model, const PlantState& state, double force, int milliseconds) {
  return held(model, state, {.force = force}, milliseconds);
}
inline PlantState charged(const PlantModel& model, const PlantState& state, double voltage,
                          int milliseconds) {
  return held(model, state, {.voltage = voltage}, milliseconds);
}

// `plain` with one effect.
template <class Effect>
PlantModel with_effect(PlantModel plain, const Effect& effect) {
  for_each_effect(plain.effects, [&](auto& slot) {
    if constexpr (std::is_same_v<std::decay_t<decltype(slot)>, std::optional<Effect>>) slot = effect;
  });
  return plain;
}

// Calls visit(effect) for each effect of the library, its parameters at their typical values.
template <class Visitor>
void for_each_typical_effect(Visitor&& visit) {
  Effects library;
  for_each_effect(library, [&]<class Effect>(std::optional<Effect>&) {
    Effect effect;
    for (const auto& p : Effect::parameters()) effect.*(p.member) = p.typical * p.si_per_unit;
    visit(effect);
  });
}

// Readings over the first `milliseconds` of ramps_and_flips; the force of a force drive is 0.1 N/kV of it.
inline std::vector<double> ramped_readings(const PlantModel& model, int milliseconds) {
  PlantState state = at_rest(model);
  std::vector<double> out;
  for (int k = 0; k < milliseconds; ++k) {
    const double u = ramps_and_flips(k);
    state = step(model, state, {.voltage = u, .force = 1e-4 * std::abs(u)}, Seconds(1e-3));
    out.push_back(displacement_reading(model, state));
  }
  return out;
}

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = a.size() == b.size() ? 0.0 : HUGE_VAL;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    worst = std::max(worst, std::abs(a[k] - b[k]));
  return worst;
}

}  // namespace biopsy::sim
