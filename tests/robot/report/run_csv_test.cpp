#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "robot/report/procedure/report.hpp"
#include "tests/robot/report/example_run.hpp"

namespace biopsy::report {
namespace {

std::vector<std::vector<std::string>> table(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

TEST(RunCsv, StartsWithTheColumnsOfARecordedDataSet) {
  const std::string csv = run_csv(example_run());
  EXPECT_EQ(csv.rfind("time_s,voltage_V,displacement_mm,plate_b_mm,current_uA,", 0), 0U);
}

TEST(RunCsv, HasOneFullRowForEveryTick) {
  const RunRecord record = example_run();
  const auto rows = table(run_csv(record));
  ASSERT_EQ(rows.size(), record.samples.size() + 1);
  for (const auto& row : rows) ASSERT_EQ(row.size(), rows.front().size());
}

TEST(RunCsv, NumbersReadBackToTheGatesMillivoltAndTheLasersMicrometre) {
  const RunRecord record = example_run();
  const auto rows = table(run_csv(record));
  for (std::size_t k = 0; k < record.samples.size(); ++k) {
    const Sample& s = record.samples[k];
    const auto& row = rows[k + 1];
    ASSERT_EQ(std::lround(std::stod(row[0]) * 1e3), s.time_ms);
    ASSERT_EQ(std::lround(std::stod(row[1]) * 1e3), std::lround(static_cast<double>(s.drive_kV) * 1e6));
    ASSERT_EQ(std::lround(std::stod(row[2]) * 1e3), std::lround(static_cast<double>(s.depth_mm) * 1e3));
    ASSERT_NEAR(std::stod(row[3]), s.plate_b_mm, 1e-5);
    ASSERT_NEAR(std::stod(row[4]), s.current_uA, 1e-3);
  }
}

TEST(RunCsv, EndsWithWhetherTheNeedleIsLocked) {
  RunRecord record = example_run();
  for (std::size_t k = 0; k < record.samples.size(); ++k) record.samples[k].locked = k % 3 == 1;
  for (const bool simulated : {true, false}) {
    record.simulated = simulated;
    const auto rows = table(run_csv(record));
    ASSERT_EQ(rows.front().back(), "locked");
    for (std::size_t k = 0; k < record.samples.size(); ++k)
      ASSERT_EQ(rows[k + 1].back(), k % 3 == 1 ? "1" : "0");
  }
}

TEST(RunCsv, LeavesOutWhatOnlyASimulationKnowsWhenTheRunWasReal) {
  RunRecord record = example_run();
  record.simulated = false;
  const auto rows = table(run_csv(record));
  for (const std::string& name : rows.front()) EXPECT_TRUE(name != "tip_mm" && name != "plate_b_mm");
  for (const auto& row : rows) ASSERT_EQ(row.size(), rows.front().size());
}

TEST(RunCsv, IsAHeaderAloneWhenNothingMovedAndNeverWritesMinusZero) {
  EXPECT_EQ(table(run_csv(example_refusal())).size(), 1U);
  RunRecord record = example_refusal();
  record.samples.resize(1);
  record.samples[0].drive_kV = -1e-9F;
  record.samples[0].depth_mm = -0.0F;
  EXPECT_EQ(run_csv(record).find("-0.0"), std::string::npos);
}

}  // namespace
}  // namespace biopsy::report
