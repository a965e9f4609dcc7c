// Which stacks are better than the paper's, and at what price: the design study that the paper leaves to
// future work.
#pragma once

#include <functional>
#include <string>

#include "sim/paper/design/evaluate.hpp"
#include "sim/paper/design/pareto.hpp"

namespace biopsy::sim::design {

// `known` is the stage that all designs are scaled from; `name` what it is called on the page. Not more than
// `kShown` of the best are kept, spread over what they reach, up to half of them such as beat the paper's;
// its own stands beside them whether or not it meets the demands.
inline constexpr std::size_t kShown = 40;
DesignStudy study_designs(const PlantModel& known, const std::string& name, const Demands& demands,
                          const SearchSize& size, const Progress& progress = {});

}  // namespace biopsy::sim::design
