// The baseline of docs/explanation/model.md, section 1, written a second time from the page alone: explicit
// Euler-Heun in steps of a few microseconds, the algebraic loop through the spring's damper solved by
// iteration. Slow, plain, and sharing no line with sim/plant/plant.cpp: what both agree on is the page.
#pragma once

#include <vector>

namespace biopsy::sim {

struct ReferenceInput {
  double voltage = 0.0;         // V, held over one sample
  double external_force = 0.0;  // N, pushes plate A down
};

struct ReferenceSample {
  double u_o, plate_a, plate_b, height, spring;  // V, m, m, m, N: at the end of each sample
};

// Starts at rest; one output a millisecond. `weight` in kg, `step` in s.
std::vector<ReferenceSample> reference_run(const std::vector<ReferenceInput>& inputs, double weight,
                                           double step = 5e-6);

}  // namespace biopsy::sim
