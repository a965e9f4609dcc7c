// Recorded inputs through the plant, and data sets written and read.
#include "sim/plant/simulate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/scratch_folder.hpp"
#include "tests/sim/effects/staged_model.hpp"
#include "tests/sim/plant/refusal.hpp"

namespace biopsy::sim {
namespace {

RecordedRun steps(std::size_t rows, double period) {
  RecordedRun run;
  run.name = "steps \"up\" \\ down";
  run.file = "steps.csv";
  run.weight = 0.070;
  run.period = period;
  for (std::size_t k = 0; k < rows; ++k) {
    run.time.push_back(static_cast<double>(k) * period);
    run.input.push_back(k < 3 ? 0.0 : (k / 20) % 2 == 0 ? 4000.0 : -3000.0);
    run.external_force.push_back(k < rows / 2 ? 0.0 : 0.1);
  }
  run.displacement.assign(rows, 0.0);
  return run;
}

TEST(Simulate, MeasuresARowBeforeItsVoltageIsApplied) {
  const RecordedRun run = simulate(PlantModel{}, steps(20, 1e-3));
  for (int k = 0; k <= 3; ++k) EXPECT_EQ(run.displacement[k], 0.0) << k;  // 4 kV is written in row 3
  EXPECT_EQ(run.current[3], 0.0);
  EXPECT_GT(run.displacement[4], 0.0);
  EXPECT_GT(run.current[4], 0.0);
}

TEST(Simulate, IsThePlantStepByStep) {
  const RecordedRun given = steps(500, 1e-3), run = simulate(PlantModel{}, given);
  PlantModel model;
  model.weight = 0.070;  // the run's, not the model's
  PlantState state = at_rest(model);
  for (std::size_t k = 0; k < 500; ++k) {
    ASSERT_EQ(run.displacement[k], state.motion.x);
    ASSERT_EQ(run.plate_b[k], plate_b(model, state));
    const double until = k + 1 < 500 ? given.time[k + 1] - given.time[k] : given.period;
    state = step(model, state, {.voltage = given.input[k], .external_force = given.external_force[k]},
                 Seconds(until));
  }
}

// Where the voltage jumps from 0 to U the charge is C1 (1 - K) U, plus what leaks within the row.
TEST(Simulate, CurrentIncludesTheChargeOfAJumpAtAnyRate) {
  for (const double period : {1e-4, 1e-3, 0.05}) {
    const RecordedRun run = simulate(PlantModel{}, steps(20, period));
    const Baseline b;
    const double leaked = b.C1 * b.K * 4000.0 * -std::expm1(-period / b.tau);
    EXPECT_NEAR(run.current[4] * period, b.C1 * (1.0 - b.K) * 4000.0 + leaked, 1e-12) << period;
  }
}

TEST(Simulate, ACoarselySampledRunIsTheSameMotion) {
  RecordedRun coarse = steps(100, 0.05), fine = steps(5000, 1e-3);
  for (std::size_t k = 0; k < 5000; ++k) {
    fine.input[k] = coarse.input[k / 50];
    fine.external_force[k] = coarse.external_force[k / 50];
  }
  const auto seldom = simulate(PlantModel{}, coarse).displacement,
             often = simulate(PlantModel{}, fine).displacement;
  for (std::size_t k = 0; k < 100; ++k) EXPECT_NEAR(seldom[k], often[50 * k], 1e-9) << k;
}

TEST(Simulate, AForceDrivenRunHasNoPlateBAndNoCurrent) {
  RecordedRun given = steps(50, 1e-3);
  given.input.assign(50, 0.5);
  const RecordedRun run = simulate(bare_mass(0.6, 140.0), given);
  EXPECT_TRUE(run.plate_b.empty());
  EXPECT_TRUE(run.current.empty());
  EXPECT_GT(run.displacement.back(), 0.0);
}

void expect_round_trip(const RecordedRun& run, Drive drive) {
  const ScratchFolder folder;
  const Dataset dataset{.title = "a \"quoted\" title\n", .sensor_noise = 0.012e-3, .runs = {run}};
  folder.write("dataset.toml", dataset_toml(dataset));
  folder.write(run.file, run_csv(run, drive));
  const Dataset read = read_dataset(folder.path(), drive);
  EXPECT_EQ(read.title, dataset.title);
  EXPECT_NEAR(*read.sensor_noise, 0.012e-3, 1e-12);
  ASSERT_EQ(read.runs.size(), 1U);
  const RecordedRun& back = read.runs[0];
  EXPECT_EQ(back.name, run.name);
  EXPECT_NEAR(back.weight, run.weight, 1e-12);
  EXPECT_NEAR(back.period, run.period, 1e-9);
  ASSERT_EQ(back.time.size(), run.time.size());
  ASSERT_EQ(back.plate_b.size(), run.plate_b.size());
  ASSERT_EQ(back.current.size(), run.current.size());
  for (std::size_t k = 0; k < run.time.size(); ++k) {
    ASSERT_NEAR(back.time[k], run.time[k], 0.51e-6);
    ASSERT_NEAR(back.input[k], run.input[k], 1e-8 * std::abs(run.input[k]));
    ASSERT_NEAR(back.displacement[k], run.displacement[k], 0.51e-9);  // a nanometre is the last digit
    ASSERT_NEAR(back.external_force[k], run.external_force[k], 1e-9);
    if (!run.plate_b.empty()) {
      ASSERT_NEAR(back.plate_b[k], run.plate_b[k], 0.51e-9);
    }
    if (!run.current.empty()) {
      ASSERT_NEAR(back.current[k], run.current[k], 1e-5 * std::abs(run.current[k]));
    }
  }
}

TEST(Dataset, WhatIsWrittenIsReadBack) {
  expect_round_trip(simulate(PlantModel{}, steps(400, 1e-3)), Drive::Stack);
  expect_round_trip(simulate(PlantModel{}, steps(400, 0.05)), Drive::Stack);
  expect_round_trip(simulate(PlantModel{}, steps(400, 1e-5)), Drive::Stack);
  RecordedRun pushed = steps(100, 1e-3);
  for (double& force : pushed.input) force *= 1e-4;
  expect_round_trip(simulate(bare_mass(0.6, 140.0), pushed), Drive::Force);
}

}  // namespace
}  // namespace biopsy::sim
