// Gain and phase margin of a sampled loop.
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "robot/control/pi_loop.hpp"

namespace biopsy::sim::tuning {

inline constexpr double kTick_s = 1e-3;

struct Requirements {
  double gain_dB = 6.0;
  double phase_degrees = 45.0;
};

// Infinite where nothing crosses. Of several crossings the worst; negative on the wrong side.
struct Margins {
  double gain_dB = 0.0;
  double phase_degrees = 0.0;
  double crossover_Hz = 0.0;  // highest gain crossing; 0 where there is none
  bool stable = false;        // by the closed loop's poles

  bool meet(const Requirements& wanted) const;
};

// The worse of both, entry by entry; the higher crossover.
Margins worse(const Margins& a, const Margins& b);

// Angular frequencies (rad/s), evenly spaced in logarithm from 0.02 Hz to Nyquist's.
const std::vector<double>& frequencies();

// The PI loop of robot/control at each of them: V per mm, exact for its 1 ms sum.
std::complex<double> controller(const PiGains& gains, double omega);

// Of a loop whose response (controller times stage) is given at frequencies(). `stable` is left false.
Margins margins(const std::vector<std::complex<double>>& loop);

}  // namespace biopsy::sim::tuning
