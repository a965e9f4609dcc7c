// Panels of a tuning: Bode plots of the loops, and the steps in time.
#pragma once

#include "sim/paper/tuning/tune.hpp"

namespace biopsy::sim::tuning {

std::vector<FigurePanel> tuning_panels(const PlantModel& model, const Tuning& tuning);

}  // namespace biopsy::sim::tuning
