// Findings as the gap workflow makes them, one of each verdict, for the tests of the reports.
#pragma once

#include <limits>

#include "sim/gap/gap_finding.hpp"

namespace biopsy::report {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

GapFinding example_effect();       // Coulomb friction, nearly Stribeck; one margin is lost
GapFinding example_parameter();    // two baseline parameters are off
GapFinding example_no_gap();       // noise only
GapFinding example_unexplained();  // a dead zone that is not in the library

}  // namespace biopsy::report
