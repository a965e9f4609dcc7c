// The score: full for right answers, none for wrong ones.
#include "tests/sim/gap/gap_score.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace biopsy::hidden {
namespace {

Answer right_answer(const HiddenCase& hidden) {
  Answer out;
  out.gap_closed = 0.98;
  const auto add = [&](const std::string& name) { out.effects.push_back({name, 0.9, {}, {}}); };
  switch (hidden.kind) {
    case HiddenKind::Nothing:
      out.verdict = "no_gap";
      break;
    case HiddenKind::Outside:
      out.verdict = "unexplained";
      break;
    case HiddenKind::Parameter:
      out.verdict = "parameter";
      for (const auto& wrong : hidden.wrong) out.parameters_changed.push_back(wrong.name);
      break;
    case HiddenKind::Single:
    case HiddenKind::Pair:
      out.verdict = "effect";
      for (const auto& name : hidden.expected()) add(name);
      for (const auto& truth : hidden.truth())
        for (auto& effect : out.effects)
          if (effect.name == truth.effect)
            effect.parameters.push_back({truth.parameter, 1.01 * truth.value, 0.01 * std::abs(truth.value)});
  }
  return out;
}

Answer effect_answer(const std::string& name, double probability) {
  return {"effect", {{name, probability, {}, {}}}, {}, 0, 0, 0, 0, 0};
}

HiddenCase first(HiddenKind kind) {
  for (const HiddenCase& hidden : hidden_cases())
    if (hidden.kind == kind) return hidden;
  return {};
}

TEST(GapScore, GivesFullMarksForRightAnswers) {
  Score score;
  for (const HiddenCase& hidden : hidden_cases()) score.add(hidden, right_answer(hidden));
  for (const Share* share : {&score.right_first, &score.right_or_tied, &score.both_names,
                             &score.parameter_found, &score.unexplained, &score.inside_interval}) {
    EXPECT_GT(share->of, 0);
    EXPECT_EQ(share->right, share->of);
  }
  EXPECT_EQ(score.false_alarm.right + score.confident_wrong.right + score.invented.right, 0);
  EXPECT_DOUBLE_EQ(score.median_gap_closed(), 0.98);
  EXPECT_TRUE(score.not_compared.empty());
  EXPECT_EQ(score.list().find("!!"), std::string::npos);
}

TEST(GapScore, GivesNoneForTheSameWrongNameEverywhere) {
  Score score;
  for (const HiddenCase& hidden : hidden_cases()) score.add(hidden, effect_answer("no_such_effect", 0.9));
  EXPECT_EQ(score.right_first.right + score.both_names.right + score.one_name.right + score.unexplained.right,
            0);
  EXPECT_EQ(score.false_alarm.percent(), 100.0);
  EXPECT_EQ(score.confident_wrong.percent(), 100.0);
}

TEST(GapScore, CountsAWrongNameAsConfidentFromOneHalfOn) {
  Score score;
  score.add(first(HiddenKind::Outside), effect_answer("coulomb_friction", 0.49));
  EXPECT_EQ(score.confident_wrong.right, 0);
  score.add(first(HiddenKind::Outside), effect_answer("coulomb_friction", 0.5));
  EXPECT_EQ(score.confident_wrong.right, 1);
}

TEST(GapScore, CallsAParameterChangeAFalseAlarmOnlyWhereNoneErred) {
  HiddenCase none = first(HiddenKind::Nothing);
  Score score;
  none.parameter_error = 0.0;
  score.add(none, {"parameter", {}, {"K"}, 0, 0, 0, 0, 0});
  EXPECT_EQ(score.false_alarm.right, 1);
  none.parameter_error = 0.015;
  score.add(none, {"parameter", {}, {"K"}, 0, 0, 0, 0, 0});
  EXPECT_EQ(score.false_alarm.right, 1);
  score.add(none, {"unexplained", {}, {}, 0, 0, 0, 0, 0});
  EXPECT_EQ(score.false_alarm.right, 2);
}

TEST(GapScore, KeepsATieApartFromTheRightName) {
  const HiddenCase hidden = first(HiddenKind::Single);
  Answer tied = effect_answer("no_such_effect", 0.6);
  tied.effects[0].confused_with = {hidden.expected().front()};
  Score score;
  score.add(hidden, tied);
  EXPECT_EQ(score.right_first.right, 0);
  EXPECT_EQ(score.right_or_tied.right, 1);
}

TEST(GapScore, CountsAnUnknownDeviationAsOutside) {
  for (const HiddenCase& hidden : hidden_cases()) {
    if (hidden.name != "coulomb_friction/strong") continue;
    Answer answer = right_answer(hidden);
    Score score;
    answer.effects[0].parameters = {
        {"force_N", hidden.truth()[0].value, std::numeric_limits<double>::quiet_NaN()}};
    score.add(hidden, answer);
    answer.effects[0].parameters = {{"force_N", hidden.truth()[0].value + 0.02, 0.01}};  // 2 deviations away
    score.add(hidden, answer);
    EXPECT_EQ(score.inside_interval.of, 2);
    EXPECT_EQ(score.inside_interval.right, 0);
    answer.effects[0].parameters = {{"otherwise_N", 1.0, 1.0}};
    score.add(hidden, answer);
    EXPECT_EQ(score.not_compared, std::vector<std::string>{"coulomb_friction.force_N"});
  }
}

TEST(GapScore, PrintsOneTableForAllMethods) {
  Score good, bad;
  for (const HiddenCase& hidden : hidden_cases()) good.add(hidden, right_answer(hidden));
  for (const HiddenCase& hidden : hidden_cases()) bad.add(hidden, effect_answer("no_such_effect", 0.9));
  const std::string table = score_table({{"biopsy gap", good}, {"BIC", bad}});
  EXPECT_NE(table.find("biopsy gap |            BIC |"), std::string::npos) << table;
  EXPECT_NE(table.find("false alarm, nothing hidden (<= 5 %)"), std::string::npos);
  EXPECT_NE(table.find("100 % of"), std::string::npos);
  EXPECT_EQ(good.wrong_name.right, 0);
  EXPECT_EQ(bad.wrong_name.percent(), 100.0);
}

}  // namespace
}  // namespace biopsy::hidden
