// Margins of loops whose margins are known on paper.
#include "sim/paper/tuning/margins.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace biopsy::sim::tuning {
namespace {

using std::numbers::pi;

template <class LoopAt>
std::vector<std::complex<double>> written(LoopAt&& loop_at) {
  std::vector<std::complex<double>> loop;
  for (const double omega : frequencies()) loop.push_back(loop_at(std::complex<double>(0.0, omega)));
  return loop;
}

// L = w e^(-sD)/s: phase margin 90 degrees - w D, gain margin pi/(2 w D).
TEST(Margins, OfAnIntegratorWithDelayAreTheClosedForm) {
  for (const double w : {2.0, 10.0, 40.0}) {
    const double D = 0.02;
    const Margins found = margins(written([&](std::complex<double> s) { return w / s * std::exp(-s * D); }));
    EXPECT_NEAR(found.phase_degrees, 90.0 - w * D * 180.0 / pi, 0.1);
    EXPECT_NEAR(found.gain_dB, 20.0 * std::log10(pi / (2.0 * w * D)), 0.05);
    EXPECT_NEAR(found.crossover_Hz, w / (2.0 * pi), 1e-3 * w);
  }
}

// L = k/(s + 1)^3: the phase is -180 degrees at sqrt(3) rad/s, where |L| = k/8.
TEST(Margins, OfThreeLagsTurnNegativeBeyondAGainOfEight) {
  for (const double k : {2.0, 7.9, 8.1, 30.0}) {
    const Margins found = margins(written([&](std::complex<double> s) { return k / std::pow(s + 1.0, 3); }));
    EXPECT_NEAR(found.gain_dB, 20.0 * std::log10(8.0 / k), 0.01);
    EXPECT_EQ(found.phase_degrees > 0.0, k < 8.0);
  }
}

TEST(Margins, AreInfiniteWhereNothingCrosses) {
  const Margins found = margins(written([](std::complex<double> s) { return 0.5 / (s + 1.0); }));
  EXPECT_TRUE(std::isinf(found.gain_dB));
  EXPECT_TRUE(std::isinf(found.phase_degrees));
  EXPECT_EQ(found.crossover_Hz, 0.0);
}

// Against the controller itself, fed with a sine.
TEST(Margins, TheControllersResponseIsThatOfPiStep) {
  const PiGains gains;
  for (const double hertz : {0.5, 5.0, 100.0}) {
    const double omega = 2.0 * pi * hertz;
    const int period = static_cast<int>(std::lround(1000.0 / hertz));
    control::PiState state{.integral = Volts(50e3), .amplitude = Volts(0)};
    std::complex<double> in, out;
    for (int k = 0; k < 4 * period; ++k) {
      const double error = std::cos(omega * k * kTick_s);
      state = control::pi_step(gains, state, Millimetres(error), Volts(100e3));
      const std::complex<double> turn = std::polar(1.0, -omega * k * kTick_s);
      in += error * turn;
      out += state.amplitude.value * turn;
    }
    EXPECT_NEAR(std::abs(out / in / controller(gains, omega) - 1.0), 0.0, 1e-6) << hertz;
  }
}

TEST(Margins, RequirementsAskForAllOfThem) {
  const Requirements wanted{6.0, 45.0};
  EXPECT_TRUE((Margins{6.1, 46.0, 1.0, true}.meet(wanted)));
  EXPECT_FALSE((Margins{5.9, 46.0, 1.0, true}.meet(wanted)));
  EXPECT_FALSE((Margins{6.1, 44.0, 1.0, true}.meet(wanted)));
  EXPECT_FALSE((Margins{6.1, 46.0, 1.0, false}.meet(wanted)));
}

}  // namespace
}  // namespace biopsy::sim::tuning
