// Stages in lanes give what step() gives, to the bit. Models and drives are drawn: the reference values times
// 0.5 to 2, voltages that ramp, jump and change sign, pushes; nothing here knows how lanes are made.
#include "sim/plant/batch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace biopsy::sim {
namespace {

constexpr Seconds kPeriod{1e-3};

class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double between(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }
  bool one_in(int n) { return std::uniform_int_distribution(1, n)(engine_) == 1; }

 private:
  std::mt19937_64 engine_;
};

PlantModel drawn_model(Dice& dice) {
  PlantModel model;
  Baseline& b = model.baseline;
  for (double Baseline::*value : {&Baseline::tau, &Baseline::V0, &Baseline::H_0, &Baseline::tau_h, &Baseline::k,
                                  &Baseline::c_k, &Baseline::c_s, &Baseline::d_film, &Baseline::m_B})
    b.*value *= std::exp2(dice.between(-1.0, 1.0));
  b.K = dice.between(0.3, 1.0);
  model.weight = dice.between(0.0, 0.2);
  return model;
}

// Ramps, holds, flips and jumps, V.
std::vector<double> drawn_drive(Dice& dice, std::size_t ticks) {
  std::vector<double> drive;
  double at = 0.0, slope = 0.0;
  for (std::size_t k = 0; k < ticks; ++k) {
    if (dice.one_in(200)) slope = dice.one_in(3) ? 0.0 : dice.between(-20.0, 20.0);
    if (dice.one_in(250)) at = -at;
    if (dice.one_in(400)) at = dice.between(-8000.0, 8000.0);
    if (dice.one_in(900)) at = slope = 0.0;
    at = std::clamp(at + slope, -8000.0, 8000.0);
    drive.push_back(at);
  }
  return drive;
}

void expect_same(const PlantState& a, const PlantState& b, std::size_t stage, std::size_t tick) {
  ASSERT_EQ(a.motion.x, b.motion.x) << "stage " << stage << ", tick " << tick;
  ASSERT_EQ(a.motion.H, b.motion.H) << "stage " << stage << ", tick " << tick;
  ASSERT_EQ(a.motion.v, b.motion.v) << "stage " << stage << ", tick " << tick;
  ASSERT_EQ(a.u_command, b.u_command);
  ASSERT_EQ(a.u_i, b.u_i);
  ASSERT_EQ(a.u_o, b.u_o);
  ASSERT_EQ(a.charge, b.charge);
  ASSERT_EQ(a.time, b.time);
  ASSERT_EQ(a.x_max, b.x_max);
  ASSERT_EQ(a.readings, b.readings);
}

// Returns how many of the stages had a lane.
std::size_t compare(const std::vector<PlantModel>& models, Dice& dice, std::size_t ticks, bool pushed) {
  PlantBatch batch(models, kPeriod);
  std::vector<PlantState> alone;
  std::vector<std::vector<double>> drives;
  for (const PlantModel& model : models)
    alone.push_back(at_rest(model)), drives.push_back(drawn_drive(dice, ticks));
  std::vector<double> voltage(models.size()), push(pushed ? models.size() : 0);
  for (std::size_t k = 0; k < ticks; ++k) {
    for (std::size_t i = 0; i < models.size(); ++i) voltage[i] = drives[i][k];
    for (double& force : push) force = dice.one_in(50) ? dice.between(-0.2, 0.4) : force;
    batch.step(voltage, push);
    for (std::size_t i = 0; i < models.size(); ++i) {
      alone[i] = step(models[i], alone[i],
                      {.voltage = voltage[i], .external_force = pushed ? push[i] : 0.0}, kPeriod);
      expect_same(batch.state(i), alone[i], i, k);
      if (testing::Test::HasFatalFailure()) return 0;
      EXPECT_EQ(batch.x(i), alone[i].motion.x);
    }
  }
  std::size_t in_lanes = 0;
  for (std::size_t i = 0; i < batch.size(); ++i) in_lanes += batch.in_lane(i);
  return in_lanes;
}

TEST(PlantBatch, LanesOfTheBaselineGiveTheBitsOfStep) {
  Dice dice(1);
  std::vector<PlantModel> models;
  for (int i = 0; i < 19; ++i) models.push_back(drawn_model(dice));
  EXPECT_EQ(compare(models, dice, 3000, false), 19U);
}

TEST(PlantBatch, LanesThatStickAndSlideGiveTheBitsOfStep) {
  Dice dice(2);
  std::vector<PlantModel> models;
  for (int i = 0; i < 13; ++i) {
    models.push_back(drawn_model(dice));
    models.back().effects.coulomb_friction = CoulombFriction{dice.between(0.0, 0.3)};
  }
  EXPECT_EQ(compare(models, dice, 3000, true), 13U);
}

TEST(PlantBatch, StagesThatHaveNoLaneStandBesideThoseThatHave) {
  Dice dice(3);
  std::vector<PlantModel> models;
  for (int i = 0; i < 12; ++i) {
    models.push_back(drawn_model(dice));
    Effects& effects = models.back().effects;
    if (i % 4 == 1) effects.stribeck_friction = StribeckFriction{};
    if (i % 4 == 2) effects.zipping_hysteresis = ZippingHysteresis{.width = 2e-5};
    if (i % 4 == 3) effects.added_mass = AddedMass{0.02};
  }
  models[8].internal_step = 0.5e-3;
  EXPECT_EQ(compare(models, dice, 1500, true), 5U);
}

TEST(PlantBatch, NoStageIsNoStep) {
  PlantBatch batch({}, kPeriod);
  batch.step({});
  EXPECT_EQ(batch.size(), 0U);
}

}  // namespace
}  // namespace biopsy::sim
