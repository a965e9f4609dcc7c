#include "sim/paper/identification/identify.hpp"

#include <gtest/gtest.h>

#include "tests/sim/paper/identification/monitored_run.hpp"
#include "tests/sim/plant/refusal.hpp"

namespace biopsy::sim {
namespace {

constexpr double kC1 = 2.0e-9, kK = 0.8, kTau = 6.9;
constexpr double kC2 = kC1 * (1.0 - kK) / kK;  // 0.5 nF, eq. (7)
constexpr double kR = kTau / (kC1 + kC2);      // 2.76 GOhm, eq. (8)

Dataset set_of(std::vector<RecordedRun> runs) {
  Dataset dataset;
  dataset.runs = std::move(runs);
  return dataset;
}

IdentifiedCircuit identified(std::vector<RecordedRun> runs) {
  return identify_circuit(set_of(std::move(runs)), "here");
}

bool within(const CircuitValue& v, double truth) {
  return v.low <= truth && truth <= v.high;
}

TEST(Identification, FindsCapacitancesAndLeakageOfThePlantFromOneStep) {
  const RecordedRun run = monitored_run(PlantModel{}, step_at(1.0, 6000.0), 25.0, 1e-3, {});
  const IdentifiedCircuit found = identified({run});
  EXPECT_TRUE(found.C1.known && found.C2.known && found.R.known);
  EXPECT_NEAR(found.C1.value, kC1, 1e-6 * kC1);
  EXPECT_NEAR(found.C2.value, kC2, 1e-6 * kC2);
  EXPECT_NEAR(found.R.value, kR, 1e-6 * kR);
  EXPECT_NEAR(found.tau.value, kTau, 1e-6 * kTau);
  EXPECT_NEAR(found.K.value, kK, 1e-6);
  EXPECT_NEAR(found.decay_charge.value, kC1 * kK, 1e-6 * kC1);
}

TEST(Identification, FitsTheMonitorsOffset) {
  std::vector<RecordedRun> runs;
  for (const double offset : {-0.8e-6, 2.5e-6})
    runs.push_back(monitored_run(PlantModel{}, step_at(1.0, 4000.0), 25.0, 2e-3,
                                 {.noise = 5e-8, .offset = offset, .seed = 7}));
  const IdentifiedCircuit found = identified(std::move(runs));
  ASSERT_EQ(found.runs.size(), 2U);
  EXPECT_NEAR(found.runs[0].offset, -0.8e-6, 4.0 * found.runs[0].offset_std);
  EXPECT_NEAR(found.runs[1].offset, 2.5e-6, 4.0 * found.runs[1].offset_std);
  EXPECT_LT(found.runs[0].offset_std, 2e-8);
  EXPECT_TRUE(within(found.R, kR)) << found.R.low << " to " << found.R.high;
  EXPECT_NEAR(found.noise, 5e-8, 5e-9);
  EXPECT_NEAR(found.misfit, 1.0, 0.2);
}

TEST(Identification, IntervalsHoldTheTruthInNineteenOfTwentyNoisySets) {
  int sets = 200, C1 = 0, C2 = 0, R = 0, tau = 0;
  for (int seed = 1; seed <= sets; ++seed) {
    std::vector<RecordedRun> runs;
    for (const double volts : {3000.0, 6000.0})
      runs.push_back(
          circuit_run(kC1, kK, kTau, step_at(2.0, volts), 22.0, 1e-2,
                      {.noise = 2e-7,
                       .offset = 3e-7,
                       .seed = static_cast<std::uint64_t>(seed) * 2 + (volts > 5000.0 ? 1U : 0U)}));
    const IdentifiedCircuit found = identified(std::move(runs));
    C1 += within(found.C1, kC1);
    C2 += within(found.C2, kC2);
    R += within(found.R, kR);
    tau += within(found.tau, kTau);
  }
  for (const int hits : {C1, C2, R, tau}) {
    EXPECT_GE(hits, 180) << "C1 " << C1 << ", C2 " << C2 << ", R " << R << ", tau " << tau;
    EXPECT_LE(hits, 198) << "C1 " << C1 << ", C2 " << C2 << ", R " << R << ", tau " << tau;
  }
}

TEST(Identification, IntervalsNarrowWithTheRootOfHowOftenTheStepIsRepeated) {
  const auto width = [](std::size_t repeats) {
    std::vector<RecordedRun> runs;
    for (std::size_t i = 0; i < repeats; ++i)
      runs.push_back(
          circuit_run(kC1, kK, kTau, step_at(2.0, 6000.0), 22.0, 1e-2, {.noise = 1e-7, .seed = 40 + i}));
    return identified(std::move(runs)).tau.std;
  };
  EXPECT_NEAR(width(1) / width(9), 3.0, 0.4);
}

TEST(Identification, StepsUpDownAndAcrossZeroInOneRunAgreeWithOneStep) {
  const Program levels = [](double t) {
    return t < 0.5 ? 0.0 : t < 12.0 ? 5000.0 : t < 20.0 ? -5000.0 : 2500.0;
  };
  const IdentifiedCircuit found = identified({monitored_run(PlantModel{}, levels, 30.0, 1e-3, {})});
  EXPECT_EQ(found.runs.front().steps, 3U);
  EXPECT_NEAR(found.C1.value, kC1, 1e-6 * kC1);
  EXPECT_NEAR(found.R.value, kR, 1e-5 * kR);
}

TEST(Identification, ASlowAmplifierChangesNothing) {
  PlantModel slow;
  slow.effects.amplifier_lag = AmplifierLag{1e-3, 0.2e-6};  // 1 ms, and 0.2 ms a kilovolt
  const IdentifiedCircuit found = identified({monitored_run(slow, step_at(1.0, 6000.0), 25.0, 1e-3, {})});
  EXPECT_NEAR(found.C1.value, kC1, 1e-3 * kC1);
  EXPECT_NEAR(found.C2.value, kC2, 3e-3 * kC2);
  EXPECT_NEAR(found.R.value, kR, 3e-3 * kR);
}

TEST(Identification, AMonitorReadAtInstantsMissesTheInrush) {
  const RecordedRun run = monitored_run(PlantModel{}, step_at(1.0, 6000.0), 25.0, 1e-3, {.mean = false});
  const IdentifiedCircuit found = identified({run});
  EXPECT_FALSE(found.C1.known || found.C2.known || found.R.known || found.K.known);
  EXPECT_TRUE(found.tau.known && found.decay_charge.known);
  EXPECT_NEAR(found.tau.value, kTau, 1e-3 * kTau);
  EXPECT_NEAR(found.decay_charge.value, kC1 * kK, 1e-3 * kC1 * kK);
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_NE(found.warnings.front().find("no inrush"), std::string::npos);
}

TEST(Identification, WarnsWhereTheLeakageModelDoesNotFit) {
  RecordedRun run = circuit_run(kC1, kK, kTau, step_at(2.0, 6000.0), 30.0, 1e-2, {.noise = 2e-8});
  for (std::size_t k = 200; k < run.current.size(); ++k)  // absorption: a second, quicker decay
    run.current[k] += 1e-6 * std::exp(-(run.time[k] - 2.0) / 0.8);
  const IdentifiedCircuit found = identified({run});
  EXPECT_GT(found.misfit, 1.5);
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_NE(found.warnings.back().find("times the noise"), std::string::npos);
}

TEST(Identification, LeavesOutUnusableRunsWithAWarning) {
  RecordedRun blind = circuit_run(kC1, kK, kTau, step_at(2.0, 6000.0), 22.0, 1e-2, {});
  RecordedRun flat = circuit_run(kC1, kK, kTau, step_at(1e9, 6000.0), 22.0, 1e-2, {});
  const RecordedRun good = circuit_run(kC1, kK, kTau, step_at(2.0, 6000.0), 22.0, 1e-2, {});
  blind.current.clear();
  blind.name = "blind";
  flat.name = "flat";
  const IdentifiedCircuit found = identified({blind, flat, good});
  EXPECT_EQ(found.runs.size(), 1U);
  ASSERT_EQ(found.warnings.size(), 2U);
  EXPECT_NE(found.warnings[0].find("\"blind\""), std::string::npos);
  EXPECT_NE(found.warnings[1].find("\"flat\""), std::string::npos);
}

TEST(Identification, WarnsOfRunsUnderVoltageAndOfKilovolts) {
  const RecordedRun late = circuit_run(kC1, kK, kTau, step_at(0.0, 6000.0), 22.0, 1e-2, {.noise = 1e-8});
  const IdentifiedCircuit begun = identified({late});
  ASSERT_EQ(begun.warnings.size(), 1U);
  EXPECT_NE(begun.warnings[0].find("begins under voltage"), std::string::npos);
  RecordedRun kilovolts = circuit_run(kC1, kK, kTau, step_at(2.0, 6000.0), 22.0, 1e-2, {.noise = 1e-8});
  for (double& volts : kilovolts.input) volts *= 1e-3;
  const IdentifiedCircuit small = identified({kilovolts});
  ASSERT_EQ(small.warnings.size(), 1U);
  EXPECT_NE(small.warnings[0].find("not in kilovolts"), std::string::npos);
}

// Levels of 100 nA, where the noise between them is 20 nA.
TEST(Identification, QuantisationCountsAsNoise) {
  int held = 0;
  constexpr int kSets = 40;
  constexpr double kLevel = 1e-7;
  for (std::uint64_t seed = 1; seed <= kSets; ++seed) {
    RecordedRun run =
        circuit_run(kC1, kK, kTau, step_at(2.0, 6000.0), 30.0, 1e-2, {.noise = 2e-8, .seed = seed});
    for (double& current : run.current) current = kLevel * std::round(current / kLevel);
    const IdentifiedCircuit found = identified({run});
    EXPECT_LT(found.misfit, 3.0);
    EXPECT_GT(found.noise, kLevel / 4.0);
    if (found.R.low <= kR && kR <= found.R.high) ++held;
  }
  EXPECT_GE(held, 32) << "of " << kSets;
}

TEST(Identification, DrawsMonitorAndFit) {
  const RecordedRun run =
      circuit_run(kC1, kK, kTau, step_at(2.0, 6000.0), 30.0, 1e-2, {.noise = 1e-8, .offset = 2e-7});
  const IdentifiedCircuit found = identified({run});
  ASSERT_EQ(found.panels.size(), 1U);
  const FigureCurve &seen = found.panels[0].curves.at(0), &fitted = found.panels[0].curves.at(1);
  ASSERT_EQ(seen.y.size(), fitted.y.size());
  ASSERT_GT(seen.y.size(), 10U);
  for (std::size_t i = 0; i < seen.y.size(); ++i) EXPECT_NEAR(seen.y[i], fitted.y[i], 0.05) << "uA";
}

TEST(Identification, RefusesADataSetWithoutCurrentWithoutAStepOrWithoutADecay) {
  RecordedRun run = circuit_run(kC1, kK, kTau, step_at(2.0, 6000.0), 22.0, 1e-2, {.noise = 1e-8});
  const RecordedRun flat = circuit_run(kC1, kK, kTau, step_at(1e9, 6000.0), 22.0, 1e-2, {.noise = 1e-8});
  const RecordedRun drowned = circuit_run(kC1, kK, kTau, step_at(2.0, 6.0), 22.0, 1e-2, {.noise = 1e-4});
  expect_refusal(refusal([&] { identified({flat}); }), "here", "no run steps its voltage");
  expect_refusal(refusal([&] { identified({drowned}); }), "here", "stands out of its noise");
  run.current.clear();
  expect_refusal(refusal([&] { identified({run}); }), "here", "current_uA");
}

TEST(Identification, RefusesARecordShorterThanATimeConstant) {
  const auto fitted = [](double seconds, double noise) {
    return refusal([&] {
      identified({circuit_run(kC1, kK, kTau, step_at(1.0, 6000.0), 1.0 + seconds, 1e-2, {.noise = noise})});
    });
  };
  expect_refusal(fitted(5.0, 0.0), "here", "too short");
  expect_refusal(fitted(5.0, 2e-8), "here", "too short");
  EXPECT_EQ(fitted(3.0 * kTau, 2e-8), "accepted");
}

}  // namespace
}  // namespace biopsy::sim
