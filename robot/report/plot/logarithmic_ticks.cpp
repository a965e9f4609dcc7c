#include <cmath>

#include "robot/report/plot/figure_svg.hpp"

namespace biopsy::report {

LogarithmicTicks logarithmic_ticks(double low, double high) {
  LogarithmicTicks ticks;
  if (!(low > 0.0) || !(high > low) || !std::isfinite(high)) return ticks;
  const bool few = high / low < 150.0;  // room for a number at 2 and 5 as well
  const double first = std::floor(std::log10(low)), last = std::floor(std::log10(high * (1.0 + 1e-9)));
  for (double decade = first; decade <= last; ++decade)
    for (int factor = 1; factor <= 9; ++factor) {
      const double tick = factor * std::pow(10.0, decade);
      if (tick < low * (1.0 - 1e-9) || tick > high * (1.0 + 1e-9)) continue;
      ticks.all.push_back(tick);
      if (factor == 1 || (few && (factor == 2 || factor == 5))) ticks.named.push_back(tick);
    }
  return ticks;
}

}  // namespace biopsy::report
