// What the needle feels, each law by its definition and in the plant.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/scratch_folder.hpp"
#include "tests/sim/effects/staged_model.hpp"
#include "tests/sim/plant/refusal.hpp"

namespace biopsy::sim {
namespace {

constexpr LayerPuncture kSkin{
    .depth = 1e-3, .force = 0.4, .deflection = 1e-3, .collapse = 0.2e-3, .cutting = 0.1};

PlantState needle_at(const PlantModel& model, double depth) {
  PlantState state = at_rest(model);
  state.motion.x = state.x_max = depth;
  return state;
}

TEST(LayerPuncture, ForceIsAParabolaThenAFallThenCutting) {
  const auto force_at = [](double x) { return kSkin.push_back(x, x); };
  EXPECT_EQ(force_at(0.9e-3), 0.0);
  EXPECT_NEAR(force_at(1.5e-3), 0.4 / 4, 1e-15);
  EXPECT_NEAR(force_at(2.0e-3), 0.4, 1e-12);
  EXPECT_NEAR(force_at(2.1e-3), 0.25, 1e-12);
  EXPECT_NEAR(force_at(2.2e-3), 0.1, 1e-12);
  EXPECT_NEAR(force_at(9e-3), 0.1, 1e-15);
}

TEST(LayerPuncture, BeforeThePunctureTheSurfaceSpringsBackTheSameWay) {
  EXPECT_EQ(kSkin.push_back(1.5e-3, 1.9e-3), kSkin.push_back(1.5e-3, 1.5e-3));
  EXPECT_FALSE(kSkin.punctured(2.0e-3));
}

TEST(LayerPuncture, WhatIsCutStaysCut) {
  EXPECT_TRUE(kSkin.punctured(2.01e-3));
  EXPECT_EQ(kSkin.push_back(1.5e-3, 4e-3), 0.0);  // back where the surface once pushed
  for (double x = 0.0; x < 4e-3; x += 1e-4) EXPECT_LE(kSkin.push_back(x, 4e-3), 0.1) << x;
}

TEST(LayerPuncture, AForceAboveThePunctureGoesThrough) {
  PlantModel model = bare_mass(3.0);
  model.effects.layer_puncture = kSkin;
  EXPECT_GT(pushed(model, needle_at(model, 1e-3), 0.41, 3000).motion.x, 5e-3);
}

TEST(LayerPuncture, ThePlantRemembersTheCutWhenTheNeedleComesAgain) {
  PlantModel model = bare_mass(3.0);
  model.effects.layer_puncture = kSkin;
  model.effects.layer_puncture->cutting = 0.0;
  PlantState state = pushed(model, at_rest(model), 0.5, 200);
  while (state.motion.x < 4e-3) state = pushed(model, state, 0.5, 1);
  while (state.motion.x > 0.5e-3) state = pushed(model, state, -0.5, 1);
  EXPECT_GE(state.x_max, 4e-3);
  EXPECT_GT(pushed(model, state, 0.1, 2000).motion.x, 4e-3);  // 0.1 N go through the cut,
  EXPECT_LT(pushed(model, needle_at(model, 0.5e-3), 0.1, 2000).motion.x,
            1.6e-3);  // but not through whole skin
}

// By hand: m dv/dt = F - c v - reopening forward and F - c v backward, once the surface has given way.
TEST(LayerPuncture, ReopeningResistsTheWayInOnly) {
  PlantModel model = bare_mass(3.0);
  model.effects.layer_puncture = kSkin;
  model.effects.layer_puncture->reopening = 0.06;
  PlantState cut = needle_at(model, 20e-3);
  cut.motion.x = 5e-3;  // far from where it was cut last
  EXPECT_NEAR(pushed(model, cut, 0.09, 1000).motion.v, (0.09 - 0.06) / 3.0, 1e-9);
  EXPECT_EQ(pushed(model, cut, 0.059, 300).motion.x, 5e-3);                 // holds a push that is weaker,
  EXPECT_NEAR(pushed(model, cut, -0.03, 300).motion.v, -0.03 / 3.0, 1e-6);  // and no pull
  PlantState whole = needle_at(model, 1.2e-3);
  EXPECT_NEAR(pushed(model, whole, 0.1, 20000).motion.x, 1.5e-3, 1e-8);  // nothing before the puncture
}

TEST(ShaftFriction, HoldsInProportionToTheLengthInside) {
  PlantModel model = bare_mass();
  model.effects.shaft_friction = ShaftFriction{.from = 1e-3, .coulomb = 20.0};  // 0.02 N/mm
  for (const double depth_mm : {2.0, 4.0, 8.0}) {
    const double holds = 0.02 * (depth_mm - 1.0);
    const PlantState start = needle_at(model, depth_mm * 1e-3);
    EXPECT_EQ(pushed(model, start, 0.99 * holds, 1000).motion.x, start.motion.x) << depth_mm;
    EXPECT_EQ(pushed(model, start, -0.99 * holds, 1000).motion.x, start.motion.x) << depth_mm;
    EXPECT_GT(pushed(model, start, 1.05 * holds, 100).motion.x, start.motion.x) << depth_mm;
    EXPECT_LT(pushed(model, start, -1.05 * holds, 100).motion.x, start.motion.x) << depth_mm;
  }
}

TEST(ShaftFriction, CountsOnlyTheLengthInsideItsOwnLayer) {
  const ShaftFriction layer{.from = 1e-3, .to = 3e-3};
  EXPECT_EQ(layer.inserted(0.5e-3), 0.0);
  EXPECT_DOUBLE_EQ(layer.inserted(2e-3), 1e-3);
  EXPECT_DOUBLE_EQ(layer.inserted(9e-3), 2e-3);
}

TEST(TissueRelaxation, ForceAtRestFadesExponentiallyWithItsTime) {
  PlantModel model = bare_mass();
  model.effects.coulomb_friction = CoulombFriction{2.0};  // a hand that holds the needle still
  model.effects.tissue_relaxation = TissueRelaxation{.from = 1e-3, .stiffness = 50.0, .time = 2.0};
  const TissueRelaxation& tissue = *model.effects.tissue_relaxation;
  PlantState state = needle_at(model, 4e-3);
  EXPECT_DOUBLE_EQ(tissue.push_back(state.motion.x, state_of<TissueRelaxation>(state)), 50.0 * 3e-3);
  for (int k = 1; k <= 6000; ++k) {
    state = step(model, state, {}, Seconds(1e-3));
    const double expected = 50.0 * 3e-3 * std::exp(-k * 1e-3 / 2.0);
    ASSERT_NEAR(tissue.push_back(state.motion.x, state_of<TissueRelaxation>(state)), expected, 1e-10);
  }
  EXPECT_EQ(state.motion.x, 4e-3);
}

TEST(TissueRelaxation, FastMotionFeelsTheFullStiffnessAndSlowMotionOnlyADrag) {
  const TissueRelaxation tissue{.from = 0.0, .stiffness = 50.0, .time = 2.0};
  EXPECT_DOUBLE_EQ(tissue.push_back(1e-3, 0.0), 0.05);
  // At constant speed the tissue trails behind by speed x time: stiffness x time is a viscosity.
  double crept = 0.0, x = 0.0;
  for (int k = 0; k < 40000; ++k) {
    x += 1e-4 * 1e-3;
    crept += 1e-3 * tissue.rate(x, crept);
  }
  EXPECT_NEAR(tissue.push_back(x, crept), 50.0 * 2.0 * 1e-4, 1e-5);
}

TEST(Tissue, LayersAreMadeOfTheTablesTissuesAtThePlansDepths) {
  const auto table = read_tissues(models_folder() / "tissues.toml");
  const auto tissue = tissue_along(paper_layers(), table);
  ASSERT_EQ(tissue.size(), 3U);
  EXPECT_DOUBLE_EQ(tissue[2].surface.depth, 2.9e-3);
  EXPECT_DOUBLE_EQ(tissue[2].shaft.from, 2.9e-3);
  EXPECT_DOUBLE_EQ(tissue[2].relaxation.from, 2.9e-3);
  EXPECT_DOUBLE_EQ(tissue[0].shaft.to, 2.0e-3);
  EXPECT_GT(tissue[2].shaft.to, 1.0);  // the last layer goes on
  EXPECT_EQ(tissue[0].surface.force, table.at("muscle").surface.force);
  EXPECT_EQ(tissue[1].surface.force, 0.0);
}

TEST(Tissue, FilesSpeakMillimetresAndTheModelMetres) {
  const ScratchFolder folder;
  folder.write(
      "t.toml",
      "[tissue.unknown]\nforce_N = 0.1\ndeflection_mm = 0.3\ncollapse_mm = 0.2\ncutting_N = 0.05\n"
      "coulomb_N_per_mm = 0.015\nviscous_N_s_per_m_per_mm = 0.05\nstiffness_N_per_mm = 0.03\ntime_s = 2\n");
  const TissueLayer layer = read_tissues(folder.path() / "t.toml").at("unknown");
  EXPECT_DOUBLE_EQ(layer.surface.force, 0.1);
  EXPECT_DOUBLE_EQ(layer.surface.deflection, 0.3e-3);
  EXPECT_DOUBLE_EQ(layer.surface.collapse, 0.2e-3);
  EXPECT_DOUBLE_EQ(layer.shaft.coulomb, 15.0);
  EXPECT_DOUBLE_EQ(layer.shaft.viscous, 50.0);
  EXPECT_DOUBLE_EQ(layer.relaxation.stiffness, 30.0);
  EXPECT_DOUBLE_EQ(layer.relaxation.time, 2.0);
}

TEST(Tissue, ANameNobodyKnowsBehavesAsUnknownTissue) {
  const auto table = read_tissues(models_folder() / "tissues.toml");
  const std::vector<Layer> layers = {{"spleen", Millimetres(0), Millimetres(20)}};
  EXPECT_EQ(tissue_along(layers, table)[0].surface.force, table.at("unknown").surface.force);
}

TEST(Tissue, LayersCountAsEnteredWhenTheirSurfaceGaveWay) {
  PlantModel model;
  model.tissue.resize(3);
  model.tissue[0].surface = {.depth = 0.0, .force = 0.1, .deflection = 0.3e-3};
  model.tissue[1].surface = {.depth = 2.0e-3, .force = 0.0};  // air: nothing to puncture
  model.tissue[2].surface = {.depth = 2.9e-3, .force = 0.1, .deflection = 0.25e-3};
  EXPECT_EQ(layers_entered(model, needle_at(model, 0.0)), 0);
  EXPECT_EQ(layers_entered(model, needle_at(model, 0.29e-3)), 0);
  EXPECT_EQ(layers_entered(model, needle_at(model, 0.31e-3)), 1);
  EXPECT_EQ(layers_entered(model, needle_at(model, 2.01e-3)), 2);
  EXPECT_EQ(layers_entered(model, needle_at(model, 3.14e-3)), 2);
  EXPECT_EQ(layers_entered(model, needle_at(model, 3.16e-3)), 3);
}

TEST(Tissue, ALayerOutOfReachIsNotFelt) {
  PlantModel far = bare_mass(0.6, 140.0), none = far;
  none.effects.coulomb_friction = CoulombFriction{0.0};  // same way of integrating
  far.tissue = {{LayerPuncture{.depth = 0.05, .force = 1.0}, ShaftFriction{.from = 0.05, .coulomb = 100.0},
                 TissueRelaxation{.from = 0.05, .stiffness = 100.0}}};
  PlantState a = at_rest(far), b = at_rest(none);
  for (int k = 0; k < 2000; ++k) {
    a = step(far, a, {.force = 0.5}, Seconds(1e-3));
    b = step(none, b, {.force = 0.5}, Seconds(1e-3));
    ASSERT_EQ(a.motion.x, b.motion.x);
  }
}

}  // namespace
}  // namespace biopsy::sim
