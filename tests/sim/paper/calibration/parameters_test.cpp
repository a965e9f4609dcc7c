// Parameters of calibration.
#include "sim/paper/calibration/parameters.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "robot/common/config_error.hpp"
#include "sim/paper/calibration/objective.hpp"
#include "sim/paper/calibration/paper_text.hpp"
#include "tests/sim/paper/calibration/start_model.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim::calibration {
namespace {

TEST(CalibrationParameters, SetTheValueOfTheirName) {
  for (const Parameter& parameter : standard_parameters()) {
    paper::PaperModel model = start_model();
    const double value = from_search(parameter, 0.1);
    set_value(model, parameter.name, value);
    EXPECT_NEAR(value_of(model, parameter.name), value, 1e-12 * value) << parameter.name;
    EXPECT_NEAR(to_search(parameter, value), 0.1, 1e-9) << parameter.name;
    EXPECT_FALSE(parameter.why.empty()) << parameter.name;
  }
}

TEST(CalibrationParameters, StayWithinWhatIsPlausible) {
  for (const Parameter& parameter : standard_parameters()) {
    EXPECT_EQ(from_search(parameter, 100.0), parameter.high) << parameter.name;
    EXPECT_EQ(from_search(parameter, -100.0), parameter.low) << parameter.name;
    EXPECT_GT(parameter.nominal, parameter.low) << parameter.name;
    EXPECT_LT(parameter.nominal, parameter.high) << parameter.name;
  }
}

TEST(CalibrationParameters, OtherFilmsDifferOnlyInTheirOwnBlock) {
  const Question question{start_model(), standard_parameters(), {}, {}};
  Eigen::VectorXd z = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(question.parameters.size()), -0.4);
  const paper::PaperModel model = turned(question.start, question.parameters, z);
  const PlantModel other = with_film(model.stage, model.bopp25);
  for (double Baseline::*shared :
       {&Baseline::L0, &Baseline::V0, &Baseline::H_0, &Baseline::tau_h, &Baseline::k})
    EXPECT_EQ(other.baseline.*shared, model.stage.baseline.*shared);
  // C2/C1 = 1/K - 1 goes with eps/d: thinner films of the same material have twice the capacitance.
  EXPECT_NEAR(1.0 / model.pi25.K - 1.0, 2.0 * (1.0 / model.stage.baseline.K - 1.0), 1e-12);
}

TEST(CalibrationParameters, BreakawayIsNeverBelowSliding) {
  const std::vector<Parameter> parameters{
      {"stribeck_friction.sliding_N", 0.01, 0.2, 0.10, 0.10, 0.5, false, ""},
      {"stribeck_friction.breakaway_N", 0.01, 0.2, 0.02, 0.02, 0.5, false, ""}};
  const auto friction =
      turned(start_model(), parameters, Eigen::VectorXd::Zero(2)).stage.effects.stribeck_friction;
  EXPECT_EQ(friction->breakaway, friction->sliding);
}

TEST(CalibrationParameters, AnEffectThatTheStageLacksComesAbsentAndWithItsTypicalShape) {
  paper::PaperModel model = start_model();
  model.stage.effects.hysteretic_spring.reset();
  set_value(model, "hysteretic_spring.yield_mm", 0.03);
  const auto& spring = *model.stage.effects.hysteretic_spring;
  EXPECT_EQ(spring.stiffness, 0.0);
  EXPECT_DOUBLE_EQ(spring.yield, 0.03e-3);
  EXPECT_EQ(spring.sharpness, 2.0);
  EXPECT_EQ(spring.beta, 0.5);
}

TEST(CalibrationParameters, RefuseAnUnknownName) {
  paper::PaperModel model = start_model();
  EXPECT_THROW(set_value(model, "stiction", 1.0), ConfigError);
  EXPECT_THROW(set_value(model, "film.pi25.colour", 1.0), ConfigError);
}

TEST(PaperText, ReadsBackAsWhatWasWritten) {
  paper::PaperModel model = start_model();
  model.pi25.tau = 456.7;
  model.joint.friction = 0.0321;
  ModelNotes notes;
  notes.values["film.pi25.tau"] = {12.0, "a test"};
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "biopsy_paper_text";
  std::filesystem::create_directories(folder);
  std::filesystem::copy_file(kModels / "tissues.toml", folder / "tissues.toml",
                             std::filesystem::copy_options::overwrite_existing);
  std::ofstream(folder / "paper.toml") << paper_toml(model, notes);
  const paper::PaperModel back = paper::read_paper_model(kModels / "rehearsal.toml", folder / "paper.toml");
  EXPECT_DOUBLE_EQ(back.pi25.tau, 456.7);
  EXPECT_DOUBLE_EQ(back.joint.friction, 0.0321);
  EXPECT_NEAR(back.needle.liver, model.needle.liver, 1e-9);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace biopsy::sim::calibration
