// The inverse static curve against the plant.
#include "sim/paper/feed_forward.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/plant/plant.hpp"

namespace biopsy::sim::paper {
namespace {

// Where plate A comes to rest at that voltage, on films that do not leak. mm
double rest_at(PlantModel model, double from, double volts) {
  model.baseline.tau = 1e9;
  model.baseline.c_s = 5.0;  // settles without ringing
  PlantState state = at_rest(model);
  for (const double u : {from, volts})
    for (int k = 0; k < 4000; ++k) state = step(model, state, {.voltage = u}, Seconds(1e-3));
  return state.motion.x * 1e3;
}

TEST(FeedForward, HoldsItsDepth) {
  for (const double depth : {0.5, 2.0, 5.0, 8.0})
    for (const double weight : {0.020, 0.100}) {
      PlantModel model;
      model.weight = weight;
      EXPECT_NEAR(rest_at(model, 0.0, holding_voltage(model, depth, 0)), depth, 1e-3);
    }
}

TEST(FeedForward, CompensatesHysteresisFromEitherSide) {
  PlantModel model;
  model.effects.zipping_hysteresis = ZippingHysteresis{.width = 0.1e-3, .free = 0.3};
  const double depth = 4.0;
  EXPECT_NEAR(rest_at(model, 0.0, holding_voltage(model, depth, 1)), depth, 0.02);
  EXPECT_NEAR(rest_at(model, 6000.0, holding_voltage(model, depth, -1)), depth, 0.02);
  EXPECT_GT(rest_at(model, 6000.0, holding_voltage(model, depth, 1)), depth + 0.5);  // the wrong side
}

TEST(FeedForward, IsBoundedBeyondTheStroke) {
  EXPECT_EQ(holding_voltage(PlantModel{}, 1000.0, 0, 7000.0), 7000.0);
  EXPECT_EQ(holding_voltage(PlantModel{}, -1.0, 0), 0.0);
}

TEST(FeedForward, ALimitedTargetNeverMovesFasterAndArrives) {
  const OfTime limited = rate_limited([](double t) { return t < 1.0 ? 6.0 : 2.0; }, 4.0, 5.0);
  for (int k = 1; k < 5000; ++k)
    EXPECT_LE(std::abs(limited(k * 1e-3) - limited((k - 1) * 1e-3)), 4.0e-3 + 1e-12);
  EXPECT_NEAR(limited(0.999), 4.0, 1e-9);
  EXPECT_EQ(limited(4.9), 2.0);
}

}  // namespace
}  // namespace biopsy::sim::paper
