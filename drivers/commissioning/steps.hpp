// The steps of a first power-up, in order: without high voltage first, then up to 0.5 kV. Every limit has its
// reason; both are printed by `biopsy commission --dry-run` and kept in the record.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "drivers/commissioning/rig.hpp"

namespace biopsy::commissioning {

struct Limit {
  std::string_view what, unit;
  double low, high;
  std::string_view why;
};

struct Measured {
  std::vector<double> values;  // one a limit, in their order; NaN: could not be measured
  std::string note;
};

struct Step {
  std::string_view name;
  std::string_view instruction;  // to the operator, before anything is measured
  std::vector<Limit> limits;
  Measured (*measure)(Rig&, Operator&);
};

const std::vector<Step>& all_steps();

}  // namespace biopsy::commissioning
