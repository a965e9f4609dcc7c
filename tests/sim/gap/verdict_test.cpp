// What share of a gap a name must close, and when better numbers are the answer: on figures chosen here.
#include "sim/gap/select/verdict.hpp"

#include <gtest/gtest.h>

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

GapVerdict verdict_of_numbers(double left) {
  Candidate number;
  number.effect = kBaseline;
  Selection selection{.start = leaving(kBefore), .best = leaving(left), .fits = {}, .selected = {}};
  selection.selected.push_back({number, 0.9, {}});
  return verdict(leaving(kBefore), selection, evidence_of_five_millimetres());
}

// What more it needs is for objections() and for the best equation to say.
TEST(Verdict, ANameThatLeavesHalfOfTheGapIsNoneHoweverFarAhead) {
  EXPECT_EQ(verdict_of_effect(left_when_closed(0.50)), GapVerdict::Unexplained);
  EXPECT_EQ(verdict_of_effect(left_when_closed(0.58)), GapVerdict::Unexplained);
  EXPECT_EQ(verdict_of_effect(left_when_closed(0.70)), GapVerdict::Effect);
}

TEST(Verdict, BetterNumbersMustFollowTheMotionToHalfAPercent) {
  EXPECT_EQ(verdict_of_numbers(15e-6), GapVerdict::Parameter);
  EXPECT_EQ(verdict_of_numbers(40e-6), GapVerdict::Unexplained);  // closes 94 %
}

}  // namespace
}  // namespace biopsy::sim::gap
