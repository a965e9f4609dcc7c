// The model that lies in the tree: plausible, and nearer to the paper than what it was made from.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "sim/calibration/objective.hpp"

namespace biopsy::sim::calibration {
namespace {

const std::filesystem::path kModels = std::filesystem::path(BIOPSY_SOURCE_DIR) / "sim/models";

double share_reached(const char* model) {
  const Question question{
      paper::read_paper_model(kModels / model, kModels / "paper.toml"), {}, calibrated_figures(), {}};
  const std::vector<PaperRow> rows = rows_at(question, Eigen::VectorXd(), true);
  const auto reached = std::count_if(rows.begin(), rows.end(), [](const PaperRow& row) { return row.ok; });
  for (const PaperRow& row : rows)
    EXPECT_TRUE(row.ok || !row.note.empty()) << row.quantity << " says no reason";
  return static_cast<double>(reached) / static_cast<double>(rows.size());
}

TEST(CalibratedModel, EveryNumberIsWithinWhatIsPlausible) {
  const paper::PaperModel model =
      paper::read_paper_model(kModels / "calibrated.toml", kModels / "paper.toml");
  for (const Knob& knob : standard_knobs()) {
    const double value = value_of(model, knob.name);
    EXPECT_GE(value, knob.low * (1.0 - 1e-3)) << knob.name;
    EXPECT_LE(value, knob.high * (1.0 + 1e-3)) << knob.name;
  }
}

TEST(CalibratedModel, ReachesFarMoreOfThePaperThanTheOneItWasMadeFrom) {
  EXPECT_GT(share_reached("calibrated.toml"), share_reached("rehearsal.toml") + 0.2);
}

}  // namespace
}  // namespace biopsy::sim::calibration
