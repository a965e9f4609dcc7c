// The committed model: plausible, and closer to the paper than its starting point.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "sim/paper/calibration/objective.hpp"
#include "sim/paper/figures/figures.hpp"
#include "sim/paper/held_out.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/expect_figures.hpp"
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

const Reproduction& committed_reproduction() {
  static const Reproduction kReproduction =
      paper::reproduce(paper::read_paper_model(kModels / "calibrated.toml", kModels / "paper.toml"));
  return kReproduction;
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

// The whole reproduction, not the brief one that the search looks at. Nine rows of ten are asked for and not
// reached: what is missed is listed here, so that a change of the model shows which rows it wins and loses.
TEST(CalibratedModel, MissesTheseRowsAndExplainsThem) {
  const std::set<std::string> expected{
      "4 oil of a pouch",
      "7b 80 g oscillates more than 50 g and 130 g, at every frequency up to 1 Hz",
      "8a stiffness of the series spring as printed",
      "9a falling edges lag behind rising ones",
      "9b RMSE over that of the square wave (9a)",
      "9c largest overshoot, of the target",
      "9c the largest overshoot is that of a falling edge",
      "9c 0.5 Hz: neither plateau is reached",
      "9c 0.1 Hz: falling edges lag",
      "9d 0.5 Hz: attenuated",
      "9d 0.5 Hz: phase kept, within a twentieth of a period",
      "11 back at 5 mm after 50 g are put on",
      "12 some sharp peaks in the displacement",
  };
  std::set<std::string> missed;
  std::size_t numbers = 0, statements = 0;
  for (const PaperFigure& figure : committed_reproduction().figures)
    for (const PaperRow& row : figure.rows) {
      if (row.kind == RowKind::Shown || row.figure == "2") continue;
      ++(row.kind == RowKind::Trend ? statements : numbers);
      if (row.ok) continue;
      missed.insert(row.figure + " " + row.quantity);
      EXPECT_GT(row.note.size(), 40U) << row.figure << " " << row.quantity << " gives no reason";
    }
  EXPECT_EQ(numbers, 22U);
  EXPECT_EQ(statements, 47U);
  EXPECT_EQ(missed, expected);
}

// The table of docs/explanation/paper.md.
TEST(CalibratedModel, ScoresAsDocumentedBesideTheLeakageModel) {
  Reproduction reproduction = committed_reproduction();
  paper::add_leakage_model(reproduction, paper::reproduce(paper::read_paper_model(kModels / "baseline.toml",
                                                                                  kModels / "paper.toml")));
  struct Met {
    int of = 0, model = 0, leakage = 0;
  } numbers, statements, closed_forms;
  for (const PaperFigure& figure : reproduction.figures)
    for (const PaperRow& row : figure.rows) {
      if (row.kind == RowKind::Shown) continue;
      Met& met = row.figure == "2" ? closed_forms : row.kind == RowKind::Trend ? statements : numbers;
      ++met.of, met.model += row.ok, met.leakage += row.leakage_ok.value_or(false);
    }
  std::vector<std::vector<std::string>> rows;
  for (const auto& [what, met] :
       {std::pair{"numbers within 20 %, and one bound", numbers},
        std::pair{"statements as stated", statements}, std::pair{"closed forms of Fig. 2", closed_forms}})
    rows.push_back({what, std::to_string(met.of), std::to_string(met.model), std::to_string(met.leakage)});
  expect_figures("paper", {"build/dev/tests/test_calibration --gtest_filter='CalibratedModel.*'",
                           "explanation/paper.md", "g++ " __VERSION__, rows});
}

TEST(CalibratedModel, HeldOutRowsAreOfThisModelAndOfTheseFigures) {
  if (!std::filesystem::exists(kModels / "held_out.toml"))
    GTEST_SKIP() << "not measured of this model: biopsy calibrate --leave-one-out";
  const paper::HeldOut held = paper::read_held_out(kModels / "held_out.toml");
  EXPECT_TRUE(held.model == paper::digests_of(kModels / "calibrated.toml", kModels / "paper.toml"))
      << "the model changed: measure anew with " << held.command;
  EXPECT_EQ(held.unknowns, standard_parameters().size());
  Reproduction reproduction = committed_reproduction();
  paper::add_held_out(reproduction, held);
  std::size_t fitted = 0, with = 0;
  for (const PaperFigure& figure : reproduction.figures)
    for (const PaperRow& row : figure.rows) {
      fitted += paper::is_fitted(row) && row.figure != "2" ? 1 : 0;
      with += row.held_out.has_value() ? 1 : 0;
    }
  EXPECT_EQ(held.numbers + held.statements, fitted);
  EXPECT_EQ(with, held.rows.size()) << "a row of another list of the paper's rows";
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
