// Pareto-optimal stacks and their trade-offs: the design study that the paper leaves to future work.
#pragma once

#include <functional>
#include <string>

#include "sim/paper/design/evaluate.hpp"
#include "sim/paper/design/pareto.hpp"

namespace biopsy::sim::design {

// `known` is the stage that all designs are scaled from, `name` its name on the page. At most `kShown` of the
// Pareto-optimal designs are kept, spread over the figures of merit, up to half of them dominating the
// paper's.
inline constexpr std::size_t kShown = 40;
DesignStudy study_designs(const PlantModel& known, const std::string& name, const Demands& demands,
                          const SearchSize& size, const Progress& progress = {});

}  // namespace biopsy::sim::design
