// A run's amplifier current as charges over stretches of time, for which eq. (2) is exact: charge from one
// instant to another = C1 (change of u_i - change of u_o), independent of the amplifier's transient between.
// SI units.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/plant/dataset.hpp"

namespace biopsy::sim::identification {

// Rows from <= m < to: row m is the time from sample m to sample m + 1, in which input[m] is held and whose
// mean current is what sample m + 1 reads.
struct Stretch {
  std::size_t from = 0, to = 0;
  double charge = 0.0;  // C
};

struct ChargeRecord {
  std::string name;
  double period = 1e-3;        // s
  std::vector<double> input;   // V, one a row; 0 before the first
  std::vector<Stretch> parts;  // gap-free: short after a step, longer the longer it was ago
  std::size_t steps = 0;
  double after_step = 0.0;  // s, from the first step to the end
  double noise = 0.0;       // A of one sample, from neighbours without a step between

  bool has_step(const Stretch& part) const;  // of the voltage, within it
};

// A step is a change by more than 2 % of the largest voltage; its charge is taken over 10 ms, or one row
// where rows are longer, so that it includes a slew or a monitor's lag of a few milliseconds. The run must
// have current.
ChargeRecord charge_record(const RecordedRun& run);

}  // namespace biopsy::sim::identification
