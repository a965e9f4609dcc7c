// What share of a gap a name must close, and when better numbers are the answer: on figures chosen here.
#include "sim/gap/select/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/gap/residual/predict.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kNoiseHere = 10e-6, kBefore = 0.5e-3;  // m

Evidence evidence_of_five_millimetres() {
  Evidence out;
  out.noise = kNoiseHere;
  out.x_high = 5e-3;
  return out;
}

ScoredModel leaving(double rms) {
  ScoredModel out;
  out.square = rms * rms;
  return out;
}

double left_when_closed(double share) {
  return kBefore - share * (kBefore - kNoiseHere);
}

// An effect that is far ahead of every other candidate.
GapVerdict verdict_of_effect(double left) {
  const Candidate first{.effect = 0}, other{.effect = 1};
  Selection selection{.start = leaving(kBefore), .best = leaving(left), .fits = {}, .selected = {}};
  CandidateFit own{.candidate = first, .scored = leaving(left)},
      next{.candidate = other, .scored = leaving(20.0 * left)};
  own.fitted = next.fitted = true;
  selection.selected.push_back({first, 0.9, {own, next}});
  return verdict(leaving(kBefore), selection, evidence_of_five_millimetres());
}

GapVerdict verdict_of_numbers(double left, const std::vector<std::string>& objections = {}) {
  Candidate number;
  number.effect = kBaseline;
  Selection selection{.start = leaving(kBefore), .best = leaving(left), .fits = {}, .selected = {}};
  selection.selected.push_back({number, 0.9, {}});
  selection.objections = objections;
  return verdict(leaving(kBefore), selection, evidence_of_five_millimetres());
}

// What more it needs is for objections() and for the best equation to say.
TEST(Verdict, ANameThatLeavesAThirdOfTheGapIsNoneHoweverFarAhead) {
  EXPECT_EQ(verdict_of_effect(left_when_closed(0.50)), GapVerdict::Unexplained);
  EXPECT_EQ(verdict_of_effect(left_when_closed(0.58)), GapVerdict::Unexplained);
  EXPECT_EQ(verdict_of_effect(left_when_closed(0.68)), GapVerdict::Unexplained);
  EXPECT_EQ(verdict_of_effect(left_when_closed(0.70)), GapVerdict::Effect);
}

// A model that runs away on the held-out runs leaves no number, and explains nothing.
TEST(Verdict, AModelThatRunsAwayExplainsNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(mean_square({1e-6, nan, 2e-6}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(mean_square({1e-6, 1e200}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(verdict_of_effect(std::sqrt(mean_square({nan}))), GapVerdict::Unexplained);
  EXPECT_EQ(gap_closed(kBefore * kBefore, mean_square({nan}), kNoiseHere), 0.0);
  EXPECT_EQ(gap_closed(mean_square({nan}), kBefore * kBefore, kNoiseHere), 1.0);
  // What holds a given model that runs away explains it only where it follows the motion.
  const Evidence evidence = evidence_of_five_millimetres();
  EXPECT_FALSE(well_explained(mean_square({nan}), kBefore * kBefore, evidence));
  EXPECT_TRUE(well_explained(mean_square({nan}), 1.1 * kNoiseHere * kNoiseHere, evidence));
}

// Half a per cent of the motion is 25 um, the noise 10.
TEST(Verdict, BetterNumbersMustFollowTheMotionToHalfAPercentAndNearlyToTheNoise) {
  EXPECT_EQ(verdict_of_numbers(14e-6), GapVerdict::Parameter);
  EXPECT_EQ(verdict_of_numbers(20e-6), GapVerdict::Unexplained);  // closes 98 %
  EXPECT_EQ(verdict_of_numbers(40e-6), GapVerdict::Unexplained);  // closes 94 %
}

TEST(Verdict, BetterNumbersAgainstWhichThereIsAnObjectionAreNotWhatIsMissing) {
  EXPECT_EQ(verdict_of_numbers(12e-6), GapVerdict::Parameter);
  EXPECT_EQ(verdict_of_numbers(12e-6, {"what it leaves is a smooth function of time"}),
            GapVerdict::Unexplained);
}

// The model rests at 0, and so may the held-out run.
TEST(Verdict, WhatTheModelMissesInTrainingRunsIsNoMatterOfNumbersAndNoAbsenceOfAGap) {
  for (const double apart : {20e-6, 100e-6}) {
    Evidence evidence = evidence_of_five_millimetres();
    EvidenceRun run{.name = "stands", .rows = {}, .windows = {}};
    for (int i = 0; i < 50; ++i) run.rows.push_back({1e-3 * i, 1e-3, 0.0, 0.0, apart});
    run.training_rows = run.rows.size();
    evidence.runs.push_back(run);
    ScoredModel follows = leaving(kNoiseHere);
    follows.hypothesis.model =
        parse_model("[baseline]\ndrive = \"force\"\nm = 1\nc_s = 5\nk = 200\n", "rig.toml");
    const Selection selection{.start = follows, .best = follows, .fits = {}, .selected = {}};
    const bool far = apart > 50e-6;
    EXPECT_EQ(verdict(leaving(kNoiseHere), selection, evidence),
              far ? GapVerdict::Unexplained : GapVerdict::NoGap);
    EXPECT_EQ(verdict(leaving(kBefore), selection, evidence),
              far ? GapVerdict::Unexplained : GapVerdict::Parameter);
  }
}

}  // namespace
}  // namespace biopsy::sim::gap
