// Calibration with a known result: rows made by a model with other parameters.
#include "sim/paper/calibration/calibrate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "robot/common/config_error.hpp"
#include "robot/common/statistics.hpp"
#include "sim/paper/calibration/leave_one_out.hpp"
#include "sim/paper/calibration/paper_text.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/open_loop.hpp"
#include "sim/plant/model_text.hpp"
#include "sim/plant/simulate.hpp"
#include "tests/sim/paper/calibration/start_model.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim::calibration {
namespace {

std::vector<Parameter> two_parameters() {
  return {{"tau", 1.0, 40.0, 6.9, 6.9, 0.7, false, ""}, {"V0", 4e-8, 4e-7, 1.9e-7, 1.9e-7, 0.5, false, ""}};
}

constexpr double kTrueTau = 4.0, kTrueV0 = 1.2e-7;

std::array<double, 2> level_and_ripple(const paper::PaperModel& model) {
  const paper::OpenLoopRun run =
      paper::run_open_loop(paper::plate_on_stack(model.stage, 11, 0.050),
                           {.amplitude = 6000.0, .frequency = 0.5, .settle = 30.0, .watch = 2.0}, true);
  return {mean(run.displacement), paper::peak_to_peak(run.displacement)};
}

// An "experiment" whose paper numbers come from kTrueTau and kTrueV0.
PaperFigure figure_with_band(const paper::PaperModel& model, double band) {
  static const std::array<double, 2> kPaper = [] {
    paper::PaperModel truth = start_model();
    truth.stage.baseline.tau = kTrueTau;
    truth.stage.baseline.V0 = kTrueV0;
    return level_and_ripple(truth);
  }();
  const auto ours = level_and_ripple(model);
  PaperFigure figure;
  figure.rows = {paper::number_row({"x", "level", "mm"}, kPaper[0], ours[0], "", band),
                 paper::number_row({"x", "ripple", "mm"}, kPaper[1], ours[1], "", band)};
  return figure;
}

PaperFigure made_up_figure(const paper::PaperModel& model) {
  return figure_with_band(model, 0.02);
}

// With the band of the paper's own numbers: seen from further away.
PaperFigure wide_figure(const paper::PaperModel& model) {
  return figure_with_band(model, paper::kBand);
}

Question made_up_question() {
  return {start_model(), two_parameters(), {{"x", made_up_figure}}, {}};
}

const Calibration& answer() {
  static const Calibration kAnswer = calibrate(made_up_question(), {.evaluations = 200});
  return kAnswer;
}

TEST(Calibrate, RecoversTheTrueParameters) {
  EXPECT_NEAR(answer().parameters[0].value, kTrueTau, 0.05 * kTrueTau);
  EXPECT_NEAR(answer().parameters[1].value, kTrueV0, 0.05 * kTrueV0);
  EXPECT_LT(answer().after, 0.05 * answer().before);
  for (const PaperRow& row : answer().rows) EXPECT_TRUE(row.ok) << row.quantity;
  EXPECT_DOUBLE_EQ(answer().model.stage.baseline.tau, answer().parameters[0].value);
}

// 2 % of the rows, by the rows' sensitivity: some per cent of the numbers, and no more than what was known.
TEST(Calibrate, EstimatesStandardDeviations) {
  for (const CalibratedParameter& found : answer().parameters) {
    EXPECT_GT(found.std, 1e-3 * found.value) << found.parameter.name;
    EXPECT_LT(found.std, 0.2 * found.value) << found.parameter.name;
    EXPECT_FALSE(found.at_bound);
  }
  EXPECT_NEAR(answer().correlations(0, 0), 1.0, 1e-12);
  EXPECT_LE(std::abs(answer().correlations(0, 1)), 1.0);
}

TEST(Calibrate, IsDeterministic) {
  const Calibration again = calibrate(made_up_question(), {.evaluations = 200});
  for (std::size_t i = 0; i < again.parameters.size(); ++i)
    EXPECT_EQ(again.parameters[i].value, answer().parameters[i].value);
}

TEST(Calibrate, UsesMeasuredRuns) {
  Question question = made_up_question();
  question.figures.clear();
  PlantModel truth = question.start.stage;
  truth.baseline.tau = kTrueTau;
  truth.baseline.V0 = kTrueV0;
  truth.effects.sensor_noise.reset();
  RecordedRun run;
  run.period = 0.02;
  run.weight = 0.050;
  for (int i = 0; i < 300; ++i) {
    run.time.push_back(i * run.period);
    run.input.push_back(i < 25 ? 0.0 : 5000.0);
  }
  run.displacement.assign(300, 0.0);
  run.external_force.assign(300, 0.0);
  question.runs = {simulate(truth, run)};
  const Calibration found = calibrate(question, {.evaluations = 200});
  EXPECT_NEAR(found.parameters[0].value, kTrueTau, 0.1 * kTrueTau);
  EXPECT_NEAR(found.parameters[1].value, kTrueV0, 0.1 * kTrueV0);
  for (const CalibratedParameter& parameter : found.parameters)
    EXPECT_LT(parameter.std, 0.5 * parameter.parameter.doubt * parameter.value)
        << parameter.parameter.name << ": the run adds information";
  ASSERT_EQ(found.runs.size(), 1U);
  EXPECT_TRUE(found.runs[0].followed);
  EXPECT_FALSE(found.kept_start);
  Eigen::VectorXd far = Eigen::VectorXd::Zero(2);
  far[1] = 1.0;
  const std::vector<RunFit> off = run_fits(question, far);
  EXPECT_FALSE(off[0].followed);
  EXPECT_GT(off[0].rms, 10.0 * found.runs[0].rms);
  EXPECT_LT(off[0].rms, 2.0 * off[0].span);
}

// A number at the edge of its range is turned to one side only; it is known as well as one that is not.
TEST(Calibrate, DeviationAtTheEdgeOfARangeIsThatWithin) {
  const auto std_of_tau = [](double low) {
    Question question = made_up_question();
    question.parameters[0].low = low;
    question.parameters[0].nominal = question.parameters[0].start = kTrueTau;
    question.parameters[1].nominal = question.parameters[1].start = kTrueV0;
    return calibrate(question, {.evaluations = 1, .last_steps = 0}).parameters[0].std;
  };
  EXPECT_NEAR(std_of_tau(kTrueTau), std_of_tau(1.0), 0.1 * std_of_tau(1.0));
}

TEST(Calibrate, ConvergesFromFarAway) {
  Question question = made_up_question();
  question.figures = {{"x", wide_figure}};
  question.parameters[0].start = 30.0;
  question.parameters[1].start = 3.5e-7;
  const Calibration found = calibrate(question, {.starts = 2, .evaluations = 50});
  EXPECT_NEAR(found.parameters[0].value, kTrueTau, 0.1 * kTrueTau);
  EXPECT_NEAR(found.parameters[1].value, kTrueV0, 0.1 * kTrueV0);
}

// A stage that 8 kV do not lift far enough is no answer, whatever rows it reaches.
TEST(Calibrate, RequiredReachDoesNotSaturate) {
  Question question = made_up_question();
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(2);
  const double without = residuals(question, none, false).squaredNorm();
  question.reach = 1e-3;
  EXPECT_DOUBLE_EQ(residuals(question, none, false).squaredNorm(), without) << "lifted easily";
  question.reach = 0.1;
  EXPECT_GT(residuals(question, none, false).squaredNorm(), without + 20.0) << "ten centimetres";
}

// All figures have the same rows: each is predicted by the fit of the others.
TEST(Calibrate, LeavesEachFigureOutOnceAndCountsWhatIsFitted) {
  Question question = made_up_question();
  question.figures = {{"8a", wide_figure}, {"8b", wide_figure}, {"9", wide_figure}};
  const paper::HeldOut found = leave_one_out(question, 6);
  EXPECT_EQ(found.unknowns, 2U);
  EXPECT_EQ(found.numbers, 6U);
  EXPECT_EQ(found.statements, 0U);
  ASSERT_EQ(found.rows.size(), 6U);
  for (const paper::HeldOutRow& row : found.rows) EXPECT_TRUE(row.ok) << row.quantity << " " << row.ours;
  question.figures.pop_back();  // 8a and 8b go together: nothing is left but the prior
  const paper::HeldOut alone = leave_one_out(question, 2);
  const auto prior = level_and_ripple(start_model());
  ASSERT_EQ(alone.rows.size(), 4U);
  for (std::size_t n = 0; n < 4; ++n) EXPECT_NEAR(alone.rows[n].ours, prior[n % 2], 1e-6 * prior[n % 2]) << n;
}

TEST(Calibrate, TellsWhichParametersTheDataDetermine) {
  Question question = made_up_question();
  question.parameters.push_back(
      {"k", 60.0, 300.0, 140.0, 140.0, 0.2, false, ""});  // the figure has a rigid pole
  question.parameters[0].start = kTrueTau;
  question.parameters[1].start = kTrueV0;
  const Calibration found = calibrate(question, {.evaluations = 1, .last_steps = 0});
  EXPECT_EQ(found.identifiability.told, 2U);
  EXPECT_NEAR(found.identifiability.directions.back().std, 1.0, 1e-6);
  EXPECT_NE(found.identifiability.directions.back().parameters.find("k"), std::string::npos);
  EXPECT_TRUE(found.parameters[2].only_prior);
  EXPECT_FALSE(found.parameters[0].only_prior);
}

// J by hand: one reading of a + b, with a std of a tenth of the priors'.
TEST(Identifiability, ASumIsKnownAndADifferenceIsThePriors) {
  const std::vector<Parameter> two{{"tau", 1.0, 40.0, 6.9, 6.9, 0.7, false, ""},
                                   {"k", 1.0, 9.0, 3.0, 3.0, 0.7, false, ""}};
  const Identifiability found = identifiability(two, Eigen::RowVector2d(10.0, 10.0));
  EXPECT_EQ(found.told, 1U);
  EXPECT_NEAR(found.directions[0].std, 1.0 / std::sqrt(201.0), 1e-12);
  EXPECT_NEAR(found.directions[1].std, 1.0, 1e-12);
  EXPECT_NEAR(found.covariance(0, 0), 101.0 / 201.0, 1e-12);
  EXPECT_NEAR(found.covariance(0, 1), -100.0 / 201.0, 1e-12);
  EXPECT_EQ(found.directions[0].parameters, "+0.71 tau +0.71 k");
}

TEST(Calibrate, ReturnsThePriorWithoutData) {
  Question question = made_up_question();
  question.figures.clear();
  const Calibration found = calibrate(question, {.evaluations = 50});
  EXPECT_NEAR(found.parameters[0].value, 6.9, 1e-6);
  EXPECT_NEAR(found.parameters[0].std, 0.7 * 6.9, 1e-6);
  EXPECT_TRUE(found.parameters[0].only_prior);
  EXPECT_TRUE(found.kept_start);
}

}  // namespace
}  // namespace biopsy::sim::calibration
