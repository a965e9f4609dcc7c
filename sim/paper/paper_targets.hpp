// Targets of Fig. 9. The text gives the frequencies, the weight and "a constant offset" but not the levels.
// Chosen to agree with the other statements: Fig. 11 regulates at 5 mm, Fig. 12 reaches 8 mm, and a sine that
// is poor "at low target values" comes near 0.
#pragma once

namespace biopsy::sim::paper {

inline constexpr double kSquareLow = 2.0, kSquareHigh = 8.0;  // mm
inline constexpr double kSineLow = 0.0, kSineHigh = 8.0;      // mm
inline constexpr double kSlowest = 0.05;                      // Hz, Fig. 9a,b
inline constexpr double kWeight = 0.050;                      // kg, IV.D to IV.F
inline constexpr const char* kTargetsNote =
    "target 2 to 8 mm (square) and 0 to 8 mm (sine): the paper's text gives the frequency but not the levels";

}  // namespace biopsy::sim::paper
