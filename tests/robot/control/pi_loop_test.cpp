// Equation (22) and its anti-windup against hand arithmetic.
#include "robot/control/pi_loop.hpp"

#include <gtest/gtest.h>

#include "robot/control/square_wave.hpp"

namespace biopsy::control {
namespace {

constexpr Volts kEnvelope{8000};
constexpr PiGains kPaper;

TEST(PiLoop, GainsAreThePapers) {
  EXPECT_EQ(kPaper.proportional_V_per_mm, 800.0);     // 0.8 kV/mm
  EXPECT_EQ(kPaper.integral_V_per_mm_per_tick, 5.0);  // 0.005 kV/mm
}

TEST(PiLoop, IsEquationTwentyTwoByHand) {
  PiState state = pi_step(kPaper, {}, Millimetres(2), kEnvelope);
  EXPECT_DOUBLE_EQ(state.amplitude.value, 800 * 2 + 5 * 2);
  state = pi_step(kPaper, state, Millimetres(1.5), kEnvelope);
  EXPECT_DOUBLE_EQ(state.amplitude.value, 800 * 1.5 + 5 * (2 + 1.5));
  state = pi_step(kPaper, state, Millimetres(-0.001), kEnvelope);
  EXPECT_DOUBLE_EQ(state.amplitude.value, -0.8 + 5 * 3.499);
}

TEST(PiLoop, AmplitudeStaysBetweenZeroAndTheEnvelope) {
  PiState state;
  for (const double error : {100.0, -100.0, 3.0, -3.0, 50.0})
    for (int k = 0; k < 100; ++k) {
      state = pi_step(kPaper, state, Millimetres(error), Volts(3000));
      ASSERT_GE(state.amplitude, Volts(0));
      ASSERT_LE(state.amplitude, Volts(3000));
    }
}

TEST(PiLoop, AnEnvelopeOfZeroOrLessGivesNothing) {
  EXPECT_EQ(pi_step(kPaper, {}, Millimetres(5), Volts(0)).amplitude, Volts(0));
  EXPECT_EQ(pi_step(kPaper, {}, Millimetres(5), Volts(-100)).amplitude, Volts(0));
}

TEST(PiLoop, AMinuteAtTheEnvelopeLeavesNoWindUp) {
  PiState state;
  for (int k = 0; k < 60000; ++k) state = pi_step(kPaper, state, Millimetres(5), Volts(3000));
  EXPECT_EQ(state.amplitude, Volts(3000));
  EXPECT_LE(state.integral, Volts(3000));
  // The error comes down: the drive leaves the envelope in the same tick, not after the integral has been
  // paid back.
  EXPECT_LT(pi_step(kPaper, state, Millimetres(2.4), Volts(3000)).amplitude, Volts(3000));
  // And without the limit the integral would have been a hundred times as large.
  EXPECT_GT(60000 * 5.0 * 5.0, 100 * state.integral.value);
}

TEST(PiLoop, AMinuteBelowZeroLeavesNoWindUpEither) {
  PiState state;
  for (int k = 0; k < 60000; ++k) state = pi_step(kPaper, state, Millimetres(-2), kEnvelope);
  EXPECT_EQ(state.amplitude, Volts(0));
  EXPECT_GE(state.integral, Volts(-10));
  EXPECT_GT(pi_step(kPaper, state, Millimetres(0.1), kEnvelope).amplitude, Volts(0));
}

TEST(PiLoop, TheIntegralOfASaturatedLoopMayStillMoveBack) {
  const PiState high{.integral = Volts(9000), .amplitude = Volts(3000)};
  EXPECT_EQ(pi_step(kPaper, high, Millimetres(-1), Volts(3000)).integral, Volts(8995));
  const PiState low{.integral = Volts(-3000), .amplitude = Volts(0)};
  EXPECT_EQ(pi_step(kPaper, low, Millimetres(1), Volts(3000)).integral, Volts(-2995));
}

TEST(PiLoop, ResumesWithoutABump) {
  for (const double error : {-0.2, 0.0, 0.3, 2.0}) {
    const PiState state = pi_resume(kPaper, Volts(2500), Millimetres(error));
    EXPECT_EQ(state.amplitude, Volts(2500));
    EXPECT_NEAR(pi_step(kPaper, state, Millimetres(error), kEnvelope).amplitude.value, 2500 + 5 * error,
                1e-9);
  }
}

TEST(SquareWave, IsTwoHertzAndBalanced) {
  int sum = 0, flips = 0;
  for (std::uint32_t tick = 0; tick < 1000; ++tick) {
    ASSERT_EQ(std::abs(polarity(tick)), 1);
    sum += polarity(tick);
    flips += tick > 0 && polarity(tick) != polarity(tick - 1);
  }
  EXPECT_EQ(sum, 0);
  EXPECT_EQ(flips, 3);  // two periods in a second
  EXPECT_EQ(polarity(0), 1);
  EXPECT_EQ(polarity(249), 1);
  EXPECT_EQ(polarity(250), -1);
  EXPECT_EQ(polarity(500), 1);
}

TEST(PiLoop, IntegratesEverythingButWhatPushesFurtherOut) {
  const PiGains gains{.proportional_V_per_mm = 0.0, .integral_V_per_mm_per_tick = 1.0};
  struct Case {
    double integral_V, error_mm, then_V;
  };
  for (const auto& [integral_V, error_mm, then_V] :
       {Case{100.0, 0.5, 100.0}, Case{101.0, -0.5, 100.5}, Case{0.0, -0.5, 0.0}, Case{-1.0, 0.5, -0.5},
        Case{1.0, -0.5, 0.5}}) {
    const PiState next =
        pi_step(gains, {.integral = Volts(integral_V), .amplitude = {}}, Millimetres(error_mm), Volts(100.0));
    EXPECT_EQ(next.integral, Volts(then_V)) << integral_V << " " << error_mm;
  }
}

}  // namespace
}  // namespace biopsy::control
