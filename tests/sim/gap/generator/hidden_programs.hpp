// What a laboratory would run, open loop: ramps, staircases, holds, changes of frequency, other weights, a
// push.
#pragma once

#include <string>
#include <vector>

#include "tests/sim/gap/generator/hidden_physics.hpp"

namespace biopsy::hidden {

struct NamedProgram {
  std::string name;
  Program program;
};

// `count` runs of 12 to 40 s; two are long and hold a bit of everything. `length` scales all times.
std::vector<NamedProgram> stage_programs(int count, double period, double length, Dice& dice);
std::vector<NamedProgram> mechanism_programs(int count, double period, double length, Dice& dice);

}  // namespace biopsy::hidden
