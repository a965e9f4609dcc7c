#include "sim/paper/tuning/margins.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace biopsy::sim::tuning {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kPoints = 1200;
constexpr double kLowest = 0.02;  // Hz, well below any crossover of interest

double decibels(double magnitude) {
  return 20.0 * std::log10(magnitude);
}

// Phases without jumps, in rad.
std::vector<double> unwrapped(const std::vector<std::complex<double>>& loop) {
  std::vector<double> phase(loop.size());
  for (std::size_t i = 0; i < loop.size(); ++i) {
    phase[i] = std::arg(loop[i]);
    if (i > 0) phase[i] -= 2.0 * kPi * std::round((phase[i] - phase[i - 1]) / (2.0 * kPi));
  }
  return phase;
}

// Zero of a line from a to b (of opposite signs), as a share of the way.
double crossing(double a, double b) {
  return a / (a - b);
}

double wrapped(double phase) {
  return phase - 2.0 * kPi * std::round(phase / (2.0 * kPi));
}

}  // namespace

bool Margins::meet(const Requirements& wanted) const {
  return stable && gain_dB >= wanted.gain_dB && phase_degrees >= wanted.phase_degrees;
}

Margins worse(const Margins& a, const Margins& b) {
  return {std::min(a.gain_dB, b.gain_dB), std::min(a.phase_degrees, b.phase_degrees),
          std::max(a.crossover_Hz, b.crossover_Hz), a.stable && b.stable};
}

const std::vector<double>& frequencies() {
  static const std::vector<double> kOmega = [] {
    std::vector<double> omega(kPoints);
    const double fastest = 0.5 / kTick_s;
    for (int i = 0; i < kPoints; ++i)
      omega[static_cast<std::size_t>(i)] =
          2.0 * kPi * kLowest * std::pow(fastest / kLowest, i / static_cast<double>(kPoints - 1));
    return omega;
  }();
  return kOmega;
}

// pi_step updates the sum first: K_p + K_i/(1 - 1/z).
std::complex<double> controller(const PiGains& gains, double omega) {
  const std::complex<double> late = std::polar(1.0, -omega * kTick_s);
  return gains.proportional_V_per_mm + gains.integral_V_per_mm_per_tick / (1.0 - late);
}

Margins margins(const std::vector<std::complex<double>>& loop) {
  const std::vector<double>& omega = frequencies();
  assert(loop.size() == omega.size());
  const std::vector<double> phase = unwrapped(loop);
  Margins found{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), 0.0, false};
  for (std::size_t i = 1; i < loop.size(); ++i) {
    const double before = decibels(std::abs(loop[i - 1])), after = decibels(std::abs(loop[i]));
    if ((before > 0.0) != (after > 0.0)) {
      const double s = crossing(before, after);
      const double here = wrapped(phase[i - 1] + s * (phase[i] - phase[i - 1]) + kPi);
      found.phase_degrees = std::min(found.phase_degrees, here * 180.0 / kPi);
      found.crossover_Hz = omega[i - 1] * std::pow(omega[i] / omega[i - 1], s) / (2.0 * kPi);
    }
    const double turned_before = wrapped(phase[i - 1] + kPi), turned = wrapped(phase[i] + kPi);
    if ((turned_before > 0.0) != (turned > 0.0) && std::abs(turned - turned_before) < kPi) {
      const double s = crossing(turned_before, turned);
      found.gain_dB = std::min(found.gain_dB, -(before + s * (after - before)));
    }
  }
  return found;
}

}  // namespace biopsy::sim::tuning
