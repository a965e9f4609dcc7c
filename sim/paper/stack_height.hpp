// Height of the stack at rest, the reference of the strain in Fig. 8b. The paper does not give it.
#pragma once

namespace biopsy::sim::paper {

// A pouch at rest, from III.A: 3.2 mL of oil in two chambers of 28.5 by 60 mm (6 by 6 cm, a tape of 3 mm in
// the middle) are 0.94 mm high on average; a lens is 1.5 times as high in its middle, where the next pouch
// rests on it; and two films of 50 um. m
inline constexpr double kPouchAtRest = 1.5 * 3.2e-6 / (2.0 * 28.5e-3 * 60e-3) + 100e-6;

constexpr double stack_height(double pouches) {
  return pouches * kPouchAtRest;
}

}  // namespace biopsy::sim::paper
