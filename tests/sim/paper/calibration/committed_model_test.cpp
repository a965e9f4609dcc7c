// The committed model: plausible, and closer to the paper than its starting point.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "sim/paper/calibration/objective.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/sim/paper/calibration/start_model.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim::calibration {
namespace {

double share_reached(const char* model) {
  const Question question{
      paper::read_paper_model(kModels / model, kModels / "paper.toml"), {}, calibrated_figures(), {}};
  const std::vector<PaperRow> rows = rows_at(question, Eigen::VectorXd(), true);
  const auto reached = std::count_if(rows.begin(), rows.end(), [](const PaperRow& row) { return row.ok; });
  for (const PaperRow& row : rows)
    EXPECT_TRUE(row.ok || !row.note.empty()) << row.quantity << " gives no reason";
  return static_cast<double>(reached) / static_cast<double>(rows.size());
}

TEST(CalibratedModel, ParametersAreWithinTheirRanges) {
  const paper::PaperModel model =
      paper::read_paper_model(kModels / "calibrated.toml", kModels / "paper.toml");
  for (const Parameter& parameter : standard_parameters()) {
    const double value = value_of(model, parameter.name);
    EXPECT_GE(value, parameter.low * (1.0 - 1e-3)) << parameter.name;
    EXPECT_LE(value, parameter.high * (1.0 + 1e-3)) << parameter.name;
  }
}

// The whole reproduction, not the brief one that the search looks at.
TEST(CalibratedModel, ReachesNineOfTenNumbersAndNineOfTenStatementsAndExplainsTheRest) {
  const paper::PaperModel model =
      paper::read_paper_model(kModels / "calibrated.toml", kModels / "paper.toml");
  std::size_t numbers = 0, numbers_ok = 0, trends = 0, trends_ok = 0;
  for (const paper::FigureEntry& figure : calibrated_figures())
    for (const PaperRow& row : figure.run(model).rows) {
      if (row.kind == RowKind::Shown) continue;
      const bool trend = row.kind == RowKind::Trend;
      ++(trend ? trends : numbers);
      if (row.ok) ++(trend ? trends_ok : numbers_ok);
      EXPECT_TRUE(row.ok || row.note.size() > 40) << row.figure << " " << row.quantity << " gives no reason";
    }
  EXPECT_GE(numbers, 20U);
  EXPECT_GE(trends, 40U);
  EXPECT_GE(10 * numbers_ok, 9 * numbers) << numbers_ok << " of " << numbers;
  EXPECT_GE(10 * trends_ok, 9 * trends) << trends_ok << " of " << trends;
}

TEST(CalibratedModel, HasCorrelations) {
  const NotedModel model = read_noted_model(kModels / "calibrated.toml");
  ASSERT_TRUE(model.notes.correlations.has_value());
  EXPECT_GE(model.notes.correlations->values.size(), 15U);
}

TEST(CalibratedModel, MeetsMoreRowsThanItsStartingPoint) {
  EXPECT_GT(share_reached("calibrated.toml"), share_reached("rehearsal.toml") + 0.2);
}

}  // namespace
}  // namespace biopsy::sim::calibration
