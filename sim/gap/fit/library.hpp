// The effects of the library behind one face: what a search needs to add one to a model and to set its
// numbers by index. Parameters are in SI here; `si_per_unit` leads back to a file's units.
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

// Every effect that a gap can be made of; sensor noise is not one: it is the floor.
const std::vector<LibraryEffect>& library();

}  // namespace biopsy::sim::gap
