// C1, C2 and R of the leakage model (eq. (2), paper) from the amplifier's current in steps of voltage, which
// the paper leaves to future work. SI units.
//
// After a step U from rest (eq. (6)) the current decays as U C1 K/tau exp(-t/tau), K = C1/(C1+C2),
// tau = R (C1+C2). The decay alone gives two values: the charge C1 K per volt, and tau. The step itself
// moves C1 (1-K) per volt at once. With both, C1 is their sum and C2 and R follow; without the second, only
// the products are known. `current` of the data set must therefore be the mean over each row (a monitor that
// is integrated or read much faster than the rows): a fast monitor read once a millisecond misses the inrush.
//
// A constant offset of the monitor is fitted for every run. Runs start at rest, discharged.
#pragma once

#include <string>
#include <vector>

#include "sim/paper/paper_figure.hpp"
#include "sim/plant/dataset.hpp"

namespace biopsy::sim {

struct CircuitValue {
  double value = 0.0;
  double std = 0.0;
  double low = 0.0, high = 0.0;  // 95 %
  bool known = false;            // false: not identifiable from these data
};

struct CircuitRun {
  std::string name;
  std::size_t steps = 0;
  double after_step = 0.0;                // s, from the first step to the end
  double offset = 0.0, offset_std = 0.0;  // A, of the monitor
};

struct IdentifiedCircuit {
  CircuitValue decay_charge, tau;  // C1 K in F, and s: from the decay
  CircuitValue jump_charge;        // C1 (1-K) in F: from the inrush
  CircuitValue C1, C2, R, K;       // F, F, Ohm: from both
  double noise = 0.0;              // A, of one sample
  double misfit = 1.0;             // rms residual, in that noise; 1 where the model fits
  std::vector<CircuitRun> runs;
  std::vector<std::string> warnings;
  std::vector<FigurePanel> panels;  // the monitor's current and the fitted one, one a run
};

// Throws ConfigError, naming `place`: no run has current; none has a step; no decay stands out of the noise;
// no run goes on for a time constant after its first step.
IdentifiedCircuit identify_circuit(const Dataset& dataset, const std::string& place);

}  // namespace biopsy::sim
