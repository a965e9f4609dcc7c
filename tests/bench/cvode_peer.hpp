// The baseline's equations integrated by SUNDIALS CVODE (variable-order Adams): what a good general solver
// makes of them.
#pragma once

#include <vector>

#include "sim/plant/plant_model.hpp"

namespace biopsy::bench {

bool cvode_is_there();

struct PeerSettings {
  double relative, absolute;  // tolerances
  bool every_tick;  // start anew at each millisecond, as a plant under control must; else only where u_i
                    // changes
};

// Plate A at the end of each millisecond, m; `voltage` in V, held over it. Empty where CVODE is not
// installed.
std::vector<double> cvode_run(const sim::Baseline& baseline, double weight,
                              const std::vector<double>& voltage, const PeerSettings& settings);

}  // namespace biopsy::bench
