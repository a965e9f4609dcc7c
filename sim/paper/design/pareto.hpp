// Pareto-optimal designs and the search for them, after Deb, Pratap, Agarwal, Meyarivan 2002
// (NSGA-II), with variation by differences (Storn, Price 1997). Seeded; the answer does not depend on how
// many work at it.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <vector>

#include "sim/paper/design/stack_design.hpp"

namespace biopsy::sim::design {

// Better or equal in stroke, ripple, bandwidth (in steps of 5 %), margin and height, and better in one. One
// that meets all demands beats any that does not; of those, the one that is closer.
bool beats(const DesignedStack& a, const DesignedStack& b);

// Those that no other beats, each once.
std::vector<DesignedStack> unbeaten(const std::vector<DesignedStack>& stacks);

struct SearchSize {
  std::size_t population = 80, generations = 24;
  std::uint64_t seed = 1;
  std::stop_token stop = {};  // ends the search after the generations that are complete
};

using Evaluate = std::function<DesignedStack(const StackDesign&)>;  // called from any thread
using Progress = std::function<void(double share)>;

// Every stack that was looked at, `start` first. Films are those that are sold (25, 50, 75, 125 um), pouches
// whole numbers.
std::vector<DesignedStack> search(const DesignedStack& start, const Evaluate& evaluate,
                                  const SearchSize& size, const Progress& progress = {});

}  // namespace biopsy::sim::design
