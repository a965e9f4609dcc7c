// Made-up figures whose numbers come from a stage with one effect that the calibrated one lacks.
#include "sim/paper/missing/find_missing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "robot/common/statistics.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/open_loop.hpp"
#include "tests/sim/paper/calibration/start_model.hpp"

namespace biopsy::sim::missing {
namespace {

constexpr double kCreepShare = 0.4, kCreepTime = 0.8;

// Level soon after the voltage and two seconds later: without creep both are the same. mm
std::array<double, 2> early_and_late(const paper::PaperModel& model, double volts, double weight) {
  PlantModel stage = model.stage;
  stage.weight = weight;
  const paper::OpenLoopRun run = paper::run_open_loop(
      stage, {.amplitude = volts, .frequency = 2.0, .settle = 0.5, .watch = 2.5, .period = 10e-3}, false);
  const auto quarter = static_cast<std::ptrdiff_t>(run.displacement.size() / 5);
  return {mean(std::vector(run.displacement.begin(), run.displacement.begin() + quarter)),
          mean(std::vector(run.displacement.end() - quarter, run.displacement.end()))};
}

template <int kVolts, int kGrams>
PaperFigure figure(const paper::PaperModel& model) {
  static const std::array<double, 2> kPaper = [] {
    paper::PaperModel truth = calibration::start_model();
    truth.stage.baseline.V0 *= 1.2;
    truth.stage.effects.pouch_creep = PouchCreep{.share = kCreepShare, .time = kCreepTime};
    return early_and_late(truth, kVolts, 1e-3 * kGrams);
  }();
  const auto ours = early_and_late(model, kVolts, 1e-3 * kGrams);
  const std::string number = std::to_string(kVolts / 1000) + (kGrams == 50 ? "" : "0");
  PaperFigure out;
  out.rows = {paper::number_row({number, "early", "mm"}, kPaper[0], ours[0], "", 0.03),
              paper::number_row({number, "late", "mm"}, kPaper[1], ours[1], "", 0.03)};
  return out;
}

calibration::Question question() {
  return {calibration::start_model(),
          {{"V0", 4e-8, 6e-7, 1.9e-7, 1.9e-7, 0.5, false, ""}},
          {{"5", figure<5000, 50>},
           {"6", figure<6000, 50>},
           {"7", figure<7000, 50>},
           {"50", figure<5000, 100>},
           {"60", figure<6000, 100>},
           {"70", figure<7000, 100>}},
          {}};
}

std::vector<Candidate> creep_and_spring() {
  return {{"spring", "hardens", {{"spring_hardening.cubic_N_per_mm3", 0.0, 0.05, 0.0, 0.0, 0.002, true, ""}}},
          {"creep",
           "creeps",
           {{"pouch_creep.share", 0.0, 1.0, 0.0, 0.0, 0.3, true, ""}},
           {{"pouch_creep.time_s", kCreepTime}, {"pouch_creep.log_share", 0.0}}}};
}

const MissingInPaper& answer() {
  static const MissingInPaper kAnswer =
      find_missing(question(), creep_and_spring(), {.steps = 2, .steps_with = 4});
  return kAnswer;
}

TEST(FindMissing, NamesTheEffectThatTheFiguresWereMadeWith) {
  ASSERT_EQ(answer().candidates.size(), 2U);
  const CandidateResult& best = answer().candidates.front();
  EXPECT_EQ(best.name, "creep");
  EXPECT_TRUE(is_named(answer(), best)) << best.held_out.won.size() << " won, " << best.held_out.lost.size();
  ASSERT_EQ(best.values.size(), 3U);
  EXPECT_NEAR(best.values.front().value, kCreepShare, 0.5 * kCreepShare) << "in four steps";
}

TEST(FindMissing, DoesNotNameAnotherEffect) {
  EXPECT_FALSE(is_named(answer(), answer().candidates.back()));
}

TEST(FindMissing, LeavesEachFigureOutOnceAndCountsEveryRow) {
  const std::set<std::string> left_out(answer().left_out.begin(), answer().left_out.end());
  EXPECT_EQ(left_out, (std::set<std::string>{"5", "6", "7", "50", "60", "70"}));
  EXPECT_EQ(answer().rows, 12U);
  EXPECT_EQ(answer().rows_held_out, 12U);
  EXPECT_EQ(answer().missed.size() + answer().met, 12U);
  EXPECT_GE(answer().missed.size(), 6U) << "one of two rows of each figure needs creep";
  for (const CandidateResult& one : answer().candidates) {
    EXPECT_EQ(static_cast<int>(one.fitted.met), static_cast<int>(answer().met) + one.fitted.net());
    EXPECT_EQ(static_cast<int>(one.held_out.met),
              static_cast<int>(answer().met_held_out) + one.held_out.net());
  }
}

// The stop comes while the second figure is left out.
TEST(FindMissing, KeepsWhatIsKnownWhenInterrupted) {
  std::stop_source source;
  int figures = 0;
  const MissingInPaper found = find_missing(
      question(), creep_and_spring(), {.steps = 1, .steps_with = 1, .stop = source.get_token()},
      [&](double share, const std::string& doing) {
        EXPECT_GE(share, 0.0);
        EXPECT_LE(share, 1.0);
        if (doing.starts_with("without") && doing.find(',') == std::string::npos && ++figures == 2)
          source.request_stop();
      });
  EXPECT_TRUE(found.interrupted);
  EXPECT_EQ(found.left_out.size(), 1U);
  EXPECT_EQ(found.rows_held_out, 2U);
  EXPECT_EQ(found.rows, 12U);
}

// 1/2^5; 4 of 4 throws and 3 of 4 together 5/16.
TEST(FindMissing, ChanceIsThatOfACoin) {
  EXPECT_DOUBLE_EQ(chance_of(0, 0), 1.0);
  EXPECT_NEAR(chance_of(5, 0), 1.0 / 32.0, 1e-12);
  EXPECT_NEAR(chance_of(3, 1), 5.0 / 16.0, 1e-12);
  EXPECT_DOUBLE_EQ(chance_of(0, 4), 1.0);
}

// Every candidate of the paper can be set in the model that is shipped, and changes something there.
TEST(PaperCandidates, AreAbsentAtTheirNominalValue) {
  const paper::PaperModel model =
      paper::read_paper_model(calibration::kModels / "calibrated.toml", calibration::kModels / "paper.toml");
  for (const Candidate& candidate : paper_candidates()) {
    EXPECT_FALSE(candidate.meaning.empty());
    EXPECT_FALSE(candidate.unknowns.empty() && candidate.set.empty()) << candidate.name;
    for (const calibration::Parameter& unknown : candidate.unknowns) {
      paper::PaperModel changed = model;
      calibration::set_value(changed, unknown.name, unknown.high);
      EXPECT_DOUBLE_EQ(calibration::value_of(changed, unknown.name), unknown.high) << unknown.name;
      if (unknown.share) {
        EXPECT_DOUBLE_EQ(calibration::value_of(model, unknown.name), unknown.nominal) << unknown.name;
      }
    }
    for (const auto& [name, value] : candidate.set)
      EXPECT_NE(calibration::value_of(model, name), value) << name;
  }
}

}  // namespace
}  // namespace biopsy::sim::missing
