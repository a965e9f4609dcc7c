// What can be hidden: every effect of the library in another parametrisation, and some that are not in it.
#pragma once

#include <array>
#include <span>
#include <string>

#include "tests/sim/gap/generator/hidden_physics.hpp"

namespace biopsy::hidden {

struct Comparable {  // a parameter of the library that means the same: value = fixed + unit * strength
  const char* name = nullptr;
  double unit = 1.0, fixed = 0.0;
};

struct CatalogueEntry {
  const char* name;
  double visible, strong;  // SI
  void (*set)(HiddenPhysics&, double);
  std::array<Comparable, 2> same{};
};

std::span<const CatalogueEntry> library_effects();
std::span<const CatalogueEntry> outside_effects();
const CatalogueEntry& catalogue_entry(const std::string& name);  // throws std::invalid_argument

}  // namespace biopsy::hidden
