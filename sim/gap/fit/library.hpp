// The effects of the library behind one type: a search adds one to a model and sets its parameters by index.
// Parameters are in SI here; value / si_per_unit is in a file's unit.
#pragma once

#include <string_view>
#include <vector>

#include "sim/effects/effect.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::gap {

struct LibraryParameter {
  std::string_view name, meaning;
  double si_per_unit = 1.0;
  double low = 0.0, high = 0.0, typical = 0.0;  // SI
  Role role = Role::Strength;

  bool is_signed() const { return low < 0.0; }
};

struct LibraryEffect {
  EffectInfo info;
  std::vector<LibraryParameter> parameters;
  bool (*present)(const PlantModel&);
  void (*add)(PlantModel&);  // with its defaults
  void (*remove)(PlantModel&);
  double (*get)(const PlantModel&, std::size_t parameter);
  void (*set)(PlantModel&, std::size_t parameter, double si);
};

// Every effect that can explain a gap: all but sensor noise.
const std::vector<LibraryEffect>& library();

// By its index; effects are numbered as int because -1 stands for the baseline.
inline const LibraryEffect& library_effect(int index) {
  return library()[static_cast<std::size_t>(index)];
}

}  // namespace biopsy::sim::gap
