// Values of [baseline] in a model file, under the names of docs/reference/model-files.md: the table that
// reading, writing and fitting share. SI units. `T` is accepted in files and not used.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "sim/plant/plant_model.hpp"

namespace biopsy::sim {

struct BaselineEntry {
  std::string_view name;
  double Baseline::*member;
  double low, high;                // sensible range
  std::string_view unit, meaning;  // no unit: a pure number
  bool stack, force;               // which drive it acts in

  bool acts_in(Drive drive) const { return drive == Drive::Force ? force : stack; }
};

// The ranges of m, c_s and k cover benchmarks of plain mechanics, from a loudspeaker's cone to a wing.
inline constexpr std::array kBaselineEntries{
    BaselineEntry{"K", &Baseline::K, 0.01, 2.0, "", "C1/(C1+C2)", true, false},
    BaselineEntry{"tau", &Baseline::tau, 1e-3, 1e6, "s", "R (C1+C2)", true, false},
    BaselineEntry{"eps_film", &Baseline::eps_film, 1.0, 100.0, "", "relative permittivity of the films", true,
                  false},
    BaselineEntry{"d_film", &Baseline::d_film, 1e-6, 1e-2, "m", "both films of a zipped pouch", true, false},
    BaselineEntry{"L0", &Baseline::L0, 1e-3, 1.0, "m", "width of a pouch", true, false},
    BaselineEntry{"V0", &Baseline::V0, 1e-10, 1e-3, "m^3", "displaced volume of a pouch", true, false},
    BaselineEntry{"H_0", &Baseline::H_0, 0.0, 0.05, "m", "height of a pouch at rest", true, false},
    BaselineEntry{"n", &Baseline::n, 1.0, 1000.0, "", "stacked pouches", true, false},
    BaselineEntry{"tau_h", &Baseline::tau_h, 1e-3, 10.0, "s", "oil flow", true, false},
    BaselineEntry{"k", &Baseline::k, 0.0, 1e9, "N/m", "spring", true, true},
    BaselineEntry{"c_k", &Baseline::c_k, 0.0, 1e3, "N s/m", "damping of the spring", true, false},
    BaselineEntry{"c_s", &Baseline::c_s, 0.0, 1e6, "N s/m", "damping of the slider", true, true},
    BaselineEntry{"fixture_mass", &Baseline::fixture_mass, 1e-4, 100.0, "kg",
                  "plate A without the run's weight", true, false},
    BaselineEntry{"m_B", &Baseline::m_B, 0.0, 100.0, "kg", "plate B", true, false},
    BaselineEntry{"m", &Baseline::m, 1e-6, 1e5, "kg", "moving mass of a force-driven stage", false, true},
    BaselineEntry{"C1", &Baseline::C1, 1e-13, 1e-3, "F", "capacitance that carries the current, eq. (7)",
                  true, false},
    BaselineEntry{"g", &Baseline::g, 0.0, 100.0, "m/s^2", "gravity", true, false}};

inline std::span<const BaselineEntry> baseline_entries() {
  return kBaselineEntries;
}

// Null where there is no such name.
inline const BaselineEntry* baseline_entry(std::string_view name) {
  const auto* found = std::find_if(kBaselineEntries.begin(), kBaselineEntries.end(),
                                   [&](const BaselineEntry& entry) { return entry.name == name; });
  return found == kBaselineEntries.end() ? nullptr : found;
}

}  // namespace biopsy::sim
