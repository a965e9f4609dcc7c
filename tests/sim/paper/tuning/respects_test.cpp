// In which respects one controller is better than another. Numbers by hand.
#include "sim/paper/tuning/respects.hpp"

#include <gtest/gtest.h>

namespace biopsy::sim::tuning {
namespace {

EvaluatedGains some() {
  EvaluatedGains gains;
  gains.nominal = {
      .settled_rmse = 0.06, .overshoot = 4.0, .undershoot = 4.0, .settling = 1.0, .sine_rmse = 0.2};
  gains.worst = gains.nominal;
  gains.worst_margins = {.gain_dB = 6.0, .phase_degrees = 45.0, .crossover_Hz = 2.0, .stable = true};
  return gains;
}

TEST(Respects, TheSameIsNoImprovement) {
  EXPECT_FALSE(improves(respects(some(), some())));
}

TEST(Respects, OneThatIsBetterAndNoneThatIsWorseIsAnImprovement) {
  EvaluatedGains faster = some();
  faster.nominal.settling = 0.8;
  faster.worst.sine_rmse *= 1.04;  // too little to be noticed
  EXPECT_TRUE(improves(respects(some(), faster)));
  EXPECT_EQ(comparison_text(respects(some(), faster)),
            "better: settling on the model (20 %); worse: nothing");
}

TEST(Respects, OneThatIsWorseSpoilsIt) {
  EvaluatedGains faster = some();
  faster.nominal.settling = 0.8;
  EvaluatedGains late = faster, close = faster;
  late.worst.undershoot *= 1.2;
  close.worst_margins.phase_degrees = 40.0;
  EXPECT_FALSE(improves(respects(some(), late)));
  EXPECT_FALSE(improves(respects(some(), close)));
}

}  // namespace
}  // namespace biopsy::sim::tuning
