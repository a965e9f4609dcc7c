#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/paper/design/design_study.hpp"
#include "sim/plant/plant.hpp"
#include "sim/plant/pouch.hpp"

namespace biopsy::sim::design {
namespace {

bool violates(const DesignedStack& stack, const std::string& words) {
  for (const std::string& broken : stack.broken)
    if (broken.find(words) != std::string::npos) return true;
  return false;
}

TEST(Design, ThePapersDesignIsThePlantItWasTakenFrom) {
  const PlantModel known;
  const Baseline made = plant_of(known, design_of(known)).baseline, &old = known.baseline;
  EXPECT_DOUBLE_EQ(made.K, old.K);
  EXPECT_NEAR(made.tau, old.tau, 1e-12);
  EXPECT_DOUBLE_EQ(made.V0, old.V0);
  EXPECT_DOUBLE_EQ(made.L0, old.L0);
  EXPECT_DOUBLE_EQ(made.d_film, old.d_film);
  EXPECT_DOUBLE_EQ(made.k, old.k);
  EXPECT_DOUBLE_EQ(made.n, old.n);
}

TEST(Design, LargerElectrodesAndThinnerFilmsTakeVoltageFromTheStackAndKeepTheMaterial) {
  const PlantModel known;
  StackDesign design = design_of(known);
  design.side_mm *= 2.0;  // four times the area
  design.film_um *= 0.5;  // and twice that
  const Baseline made = plant_of(known, design).baseline;
  const double C2 = 8.0 * 0.5e-9;  // eight times 2.0e-9 (1 - 0.8)/0.8
  EXPECT_NEAR(made.K, 2.0e-9 / (2.0e-9 + C2), 1e-12);
  const double material = 6.9 * (1.0 - 0.8);  // R C2, s
  EXPECT_NEAR(made.tau * (1.0 - made.K), material, 1e-12);
}

TEST(Design, ThePapersStrokeIsTheSimulatedOneAfterAMinuteAndTheEquilibriumsOfItsMeanPressure) {
  const PlantModel known;
  const Demands demands;
  const DesignedStack paper = evaluate(known, design_of(known), demands);
  PlantModel plant = known;
  plant.weight = 0.050;
  PlantState state = at_rest(plant);
  double sum = 0.0, low = 1.0, high = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    state =
        step(plant, state, {.voltage = i / 250 % 2 == 0 ? 6000.0 : -6000.0, .external_force = demands.push_N},
             Seconds(1e-3));
    if (i < 59'500) continue;
    sum += state.motion.x;
    low = std::min(low, state.motion.x);
    high = std::max(high, state.motion.x);
  }
  EXPECT_NEAR(paper.figures.stroke_mm, 1e3 * sum / 500, 0.002);
  EXPECT_NEAR(paper.figures.ripple_mm, 1e3 * (high - low), 0.02 * 1e3 * (high - low));
  const Baseline& b =
      plant.baseline;  // u_o^2 on average, from K_1 of eq. (16) and its decay over half a period
  const double a = 0.25, first = 2.0 * b.K / (1.0 + std::exp(-a / b.tau)) * 6000.0;
  const double square = first * first * b.tau / (2.0 * a) * -std::expm1(-2.0 * a / b.tau);
  const double load = (plant.mass_A() + b.m_B) * b.g;
  const double H = equilibrium(b, pressure(b, std::sqrt(square)), load + demands.push_N).H;
  EXPECT_NEAR(paper.figures.stroke_mm, 1e3 * (b.n * (H - b.H_0) - demands.push_N / b.k),
              0.02 * paper.figures.stroke_mm);
}

// Another way to the same number: a stack of which nothing but the films holds the voltage.
TEST(Design, TheFieldIsThatOfAStackWhoseFilmsHoldTheWholeVoltage) {
  PlantModel plant;
  plant.baseline.K = 1.0 - 1e-9;
  PlantState state = at_rest(plant);
  state = step(plant, state, {.voltage = 6000.0}, Seconds(1e-3));
  StackDesign design = design_of(PlantModel{});
  design.drive_kV = 6.0;
  const DesignedStack stack = evaluate(PlantModel{}, design, {});
  EXPECT_NEAR(stack.figures.field_V_per_um, 1e-6 * state.u_o / plant.baseline.d_film,
              1e-3 * stack.figures.field_V_per_um);
}

// Reynolds: a film of oil half as thick flows four times as slowly, one under twice the field four times as
// fast.
TEST(Design, OilFlowsAsAViscousFilm) {
  const PlantModel known;
  StackDesign design = design_of(known);
  design.oil_mL *= 0.5;
  EXPECT_NEAR(plant_of(known, design).baseline.tau_h, 4.0 * known.baseline.tau_h, 1e-9);
  design = design_of(known);
  design.drive_kV *= 2.0;
  EXPECT_NEAR(plant_of(known, design).baseline.tau_h, 0.25 * known.baseline.tau_h, 1e-9);
}

TEST(Design, BandwidthOfOilAloneAndOfSpringAloneAreTheTextbooks) {
  PlantModel oil;
  oil.baseline.k = 1e7;  // as good as rigid
  oil.baseline.c_s = 0.0;
  oil.baseline.c_k = 10.0;
  const double high_pressure = 1e9;  // where load does not change the height
  EXPECT_NEAR(bandwidth(oil, high_pressure, 1.0), 1.0 / (2.0 * std::numbers::pi * oil.baseline.tau_h), 0.06);
  PlantModel spring;
  spring.baseline.tau_h = 1e-6;
  spring.baseline.c_s = spring.baseline.c_k = 1e-4;
  const double natural = std::sqrt(spring.baseline.k / spring.mass_A()) / (2.0 * std::numbers::pi);
  EXPECT_NEAR(bandwidth(spring, high_pressure, 1.0), natural * std::sqrt(1.0 + std::numbers::sqrt2), 0.12);
}

// Swing of plate A when the amplitude of a constant voltage on a stack that does not leak is changed by 1 %.
double swing_at(const PlantModel& plant, double frequency) {
  PlantState state = at_rest(plant);
  double low = 1.0, high = -1.0;
  const double settle = 4.0 + 3.0 / frequency;
  for (double t = 0.0; t < settle + 1.0 / frequency; t += 1e-3) {
    const double volts = 5000.0 * (1.0 + 0.01 * std::sin(2.0 * std::numbers::pi * frequency * t));
    state = step(plant, state, {.voltage = volts}, Seconds(1e-3));
    if (t < settle) continue;
    low = std::min(low, state.motion.x);
    high = std::max(high, state.motion.x);
  }
  return high - low;
}

TEST(Design, BandwidthIsWhereTheSimulatedNeedleFollowsByThreeDecibels) {
  PlantModel plant;
  plant.baseline.tau = 1e6;
  const double load = (plant.mass_A() + plant.baseline.m_B) * plant.baseline.g;
  const double f = bandwidth(plant, pressure(plant.baseline, plant.baseline.K * 5000.0), load);
  EXPECT_NEAR(swing_at(plant, f) / swing_at(plant, 0.1), std::numbers::sqrt2 / 2.0, 0.03);
}

TEST(Design, FilmsHaveTheMakersGuaranteedStrength) {
  EXPECT_DOUBLE_EQ(guaranteed_strength(25.4), 236.0);
  EXPECT_DOUBLE_EQ(guaranteed_strength(127.0), 118.0);
  EXPECT_NEAR(guaranteed_strength(38.1), 0.5 * (236.0 + 197.0), 1e-9);
  EXPECT_DOUBLE_EQ(guaranteed_strength(200.0), 118.0);
}

TEST(Design, HeightIsThatOfSixteenAndAHalfMillimetresForElevenOfThePapersPouches) {
  EXPECT_NEAR(stack_height_mm(design_of(PlantModel{})), 11.0 * (1.5 * 3200.0 / (57.0 * 60.0) + 0.1), 1e-9);
}

TEST(Design, ViolatedRequirementsAreNamed) {
  const PlantModel known;
  const StackDesign paper = design_of(known);
  const auto judged = [&](auto change) {
    StackDesign design = paper;
    change(design);
    return evaluate(known, design, {});
  };
  EXPECT_TRUE(judged([](StackDesign&) {}).broken.empty());
  const DesignedStack thin =
      judged([](StackDesign& d) { d.film_um = 25.0, d.drive_kV = 8.0, d.side_mm = 40.0; });
  EXPECT_LT(thin.figures.breakdown_margin, 2.0);
  EXPECT_TRUE(violates(thin, "field"));
  EXPECT_TRUE(violates(judged([](StackDesign& d) { d.pouches = 22; }), "mm high"));
  EXPECT_TRUE(violates(judged([](StackDesign& d) { d.drive_kV = 2.0; }), "stroke"));
  EXPECT_TRUE(violates(judged([](StackDesign& d) { d.oil_mL = 14.0; }), "lie flat"));
  EXPECT_TRUE(violates(judged([](StackDesign& d) { d = {1.8, 70.0, 25.0, 6.0, 0.44, 7.0}; }), "strain"));
  EXPECT_GT(thin.shortfall, 0.0);
}

DesignedStack with(double stroke, double ripple, double height, double shortfall = 0.0) {
  DesignedStack stack;
  stack.figures = {stroke, ripple, 5.0, 50.0, 3.0, height};
  stack.shortfall = shortfall;
  return stack;
}

TEST(Pareto, FrontHasNoDominatedAndNoRepeatedDesigns) {
  const std::vector<DesignedStack> best =
      unbeaten({with(5, 0.1, 10), with(6, 0.1, 10), with(6, 0.2, 8), with(6, 0.1, 10), with(9, 0.0, 5, 0.1)});
  ASSERT_EQ(best.size(), 2U);
  EXPECT_EQ(best[0].figures.stroke_mm, 6.0);
  EXPECT_EQ(best[1].figures.height_mm, 8.0);
}

TEST(Pareto, AFeasibleDesignDominatesAnyInfeasibleOne) {
  EXPECT_TRUE(beats(with(1, 9, 99), with(9, 0, 1, 0.01)));
  EXPECT_TRUE(beats(with(1, 9, 99, 0.1), with(9, 0, 1, 0.2)));
  EXPECT_FALSE(beats(with(5, 0.1, 10), with(5, 0.1, 10)));
}

class DesignStudyTest : public testing::Test {
 protected:
  static DesignStudy studied(std::uint64_t seed) {
    return study_designs(PlantModel{}, "baseline", {}, {.population = 32, .generations = 6, .seed = seed});
  }
};

TEST_F(DesignStudyTest, BestDesignsAreParetoOptimalAndFeasible) {
  const DesignStudy study = studied(1);
  const Demands demands;
  ASSERT_GE(study.best.size(), 10U);
  EXPECT_LE(study.best.size(), kShown);
  for (const DesignedStack& a : study.best) {
    for (const DesignedStack& b : study.best) EXPECT_FALSE(beats(a, b));
    const DesignedStack again = evaluate(PlantModel{}, a.design, demands);
    EXPECT_TRUE(again.broken.empty());
    EXPECT_EQ(again.figures.stroke_mm, a.figures.stroke_mm);
    EXPECT_GE(a.figures.stroke_mm, demands.stroke_mm);
    EXPECT_GE(a.figures.breakdown_margin, demands.margin);
    EXPECT_LE(a.figures.height_mm, demands.height_mm);
    EXPECT_LE(a.figures.stroke_mm, demands.strain * a.figures.height_mm);
    EXPECT_EQ(a.design.pouches, std::round(a.design.pouches));
    EXPECT_TRUE(a.design.film_um == 25 || a.design.film_um == 50 || a.design.film_um == 75 ||
                a.design.film_um == 125);
    EXPECT_LE(a.design.drive_kV, 8.0);
  }
}

TEST_F(DesignStudyTest, IsDeterministicForASeed) {
  const DesignStudy one = studied(1), same = studied(1), other = studied(2);
  ASSERT_EQ(one.best.size(), same.best.size());
  for (std::size_t i = 0; i < one.best.size(); ++i)
    EXPECT_EQ(one.best[i].figures.stroke_mm, same.best[i].figures.stroke_mm);
  EXPECT_NE(one.best.front().figures.stroke_mm, other.best.front().figures.stroke_mm);
}

TEST_F(DesignStudyTest, ThePapersOwnDesignIsAPointInEveryPanel) {
  const DesignStudy study = studied(1);
  ASSERT_EQ(study.panels.size(), 4U);
  for (const FigurePanel& panel : study.panels) {
    ASSERT_EQ(panel.curves.size(), 2U);
    ASSERT_EQ(panel.curves[1].x.size(), 1U);
    EXPECT_LT(panel.curves[1].x[0], panel.x_high);
    EXPECT_LT(panel.curves[1].y[0], panel.y_high);
    EXPECT_EQ(panel.curves[0].x.size(), study.best.size());
  }
}

TEST_F(DesignStudyTest, LaterGenerationsDominateTheFirst) {
  const PlantModel known;
  const auto found = [&](std::size_t generations) {
    const Demands demands;
    return search(evaluate(known, design_of(known), demands),
                  [&](const StackDesign& design) { return evaluate(known, design, demands); },
                  {32, generations, 1});
  };
  const std::vector<DesignedStack> first = unbeaten(found(0)), later = unbeaten(found(8));
  std::size_t beaten = 0;
  for (const DesignedStack& old : first)
    for (const DesignedStack& one : later)
      if (beats(one, old)) {
        ++beaten;
        break;
      }
  EXPECT_GE(beaten, 2U);
  for (const DesignedStack& one : later)
    for (const DesignedStack& old : first) EXPECT_FALSE(beats(old, one));
}

}  // namespace
}  // namespace biopsy::sim::design
