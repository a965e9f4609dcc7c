// What may be hidden in a rig, and how strong it is drawn.
#pragma once

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "tests/bench/blind/blind_rig.hpp"

namespace biopsy::blind {

using Random = std::mt19937_64;

double between(Random& random, double low, double high);
double either_sign(Random& random, double low, double high);

// Sizes of a rig that strengths are drawn in: stroke [m], force that moves it over the stroke [N], speed
// [m/s].
struct Sizes {
  double stroke, force, speed, mass, spring, volts;
};

struct Law {
  std::string name;
  std::function<void(Extra&, Random&, const Sizes&)> add;
  std::string variables = {};  // outside the library
};

const std::vector<Law>& stage_laws();
const std::vector<Law>& mass_laws();
const std::vector<Law>& outside_stage_laws();
const std::vector<Law>& outside_mass_laws();

}  // namespace biopsy::blind
