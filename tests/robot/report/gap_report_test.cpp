#include "robot/report/gap/gap_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "robot/common/config_error.hpp"
#include "robot/report/gap/gap_diff.hpp"
#include "robot/report/gap/gap_labels.hpp"
#include "tests/robot/report/gap_example.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::report {
namespace {

using nlohmann::ordered_json;
std::vector<std::string> keys(const ordered_json& object) {
  std::vector<std::string> names;
  for (const auto& item : object.items()) names.push_back(item.key());
  return names;
}

using Names = std::vector<std::string>;

void expect_interface(const ordered_json& gap) {
  const Names all = keys(gap);
  const Names interface {
    "verdict", "effects", "parameters_changed", "rmse_mm", "gap_closed", "where", "next_experiment",
        "held_out_runs", "seconds"
  };
  ASSERT_GE(all.size(), interface.size());
  EXPECT_EQ(Names(all.begin(), all.begin() + 9), interface);
  EXPECT_EQ(
      Names(all.begin() + 9, all.end()),
      (Names{"sentence", "training_runs", "candidates", "shapes", "margins", "warnings", "noise_floor_std_mm",
             "partial", "rejected", "comparison", "data", "fits", "straw_men", "proposed"}));
  EXPECT_EQ(keys(gap["rmse_mm"]), (Names{"before", "after", "noise_floor"}));
  for (const auto& effect : gap["effects"]) {
    EXPECT_EQ(keys(effect), (Names{"name", "probability", "parameters", "confused_with"}));
    for (const auto& parameter : effect["parameters"]) EXPECT_EQ(keys(parameter), (Names{"value", "std"}));
    for (const auto& other : effect["confused_with"]) EXPECT_EQ(keys(other), (Names{"name", "probability"}));
  }
  for (const auto& changed : gap["parameters_changed"])
    EXPECT_EQ(keys(changed), (Names{"name", "before", "after", "std"}));
  for (const auto& regime : gap["where"])
    EXPECT_EQ(keys(regime), (Names{"regime", "share_of_time", "share_of_excess_error"}));
  for (const char* list : {"effects", "parameters_changed", "where", "held_out_runs"})
    EXPECT_TRUE(gap[list].is_array()) << list;
}

TEST(GapJson, HoldsTheInterfaceKeyByKeyForEveryVerdict) {
  const std::pair<GapFinding, const char*> kinds[] = {{example_effect(), "effect"},
                                                      {example_parameter(), "parameter"},
                                                      {example_no_gap(), "no_gap"},
                                                      {example_unexplained(), "unexplained"},
                                                      {GapFinding{}, "no_gap"}};
  for (const auto& [finding, verdict] : kinds) {
    const ordered_json gap = ordered_json::parse(gap_json(finding));
    expect_interface(gap);
    EXPECT_EQ(gap["verdict"], verdict);
  }
}

TEST(GapJson, CarriesTheNumbersOfTheFindingUnrounded) {
  const ordered_json gap = ordered_json::parse(gap_json(example_effect()));
  EXPECT_EQ(gap["effects"][0]["name"], "coulomb_friction");
  EXPECT_EQ(gap["effects"][0]["parameters"]["force_N"]["value"], 0.030);
  EXPECT_EQ(gap["effects"][0]["parameters"]["force_N"]["std"], 0.001);
  EXPECT_EQ(gap["effects"][0]["confused_with"][0]["probability"], 0.02);
  EXPECT_EQ(gap["rmse_mm"]["before"], 0.1302);
  EXPECT_EQ(gap["gap_closed"], 0.99);
  EXPECT_EQ(gap["where"][0]["regime"], "after_reversal");
  EXPECT_EQ(gap["next_experiment"], (ordered_json{{"name", "slow_triangle"},
                                                  {"separates", {"coulomb_friction", "stribeck_friction"}}}));
  EXPECT_EQ(gap["held_out_runs"], ordered_json::array({"ramp-100g"}));
  EXPECT_EQ(gap["seconds"], 21.4);
  const ordered_json changed = ordered_json::parse(gap_json(example_parameter()))["parameters_changed"];
  EXPECT_EQ(changed[1],
            (ordered_json{{"name", "d_film"}, {"before", 100e-6}, {"after", 104e-6}, {"std", 0.9e-6}}));
}

TEST(GapJson, WhatIsNotKnownIsNull) {
  EXPECT_TRUE(ordered_json::parse(gap_json(example_no_gap()))["next_experiment"].is_null());
  GapFinding f = example_effect();
  f.gap_closed = f.rmse_after = f.effects[0].parameters[0].std = kNan;
  f.rmse_before = std::numeric_limits<double>::infinity();
  const ordered_json gap = ordered_json::parse(gap_json(f));
  EXPECT_TRUE(gap["gap_closed"].is_null());
  EXPECT_TRUE(gap["rmse_mm"]["before"].is_null());
  EXPECT_TRUE(gap["rmse_mm"]["after"].is_null());
  EXPECT_TRUE(gap["effects"][0]["parameters"]["force_N"]["std"].is_null());
  EXPECT_TRUE(gap["candidates"][5]["held_out_rmse_mm"].is_null());  // never fitted
  expect_interface(gap);
}

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

GapFinding example_proposed() {
  GapFinding f = example_unexplained();
  ProposedTerm term;
  term.name = "proposed";
  term.expression = "a v^3 + b x v";
  term.coefficients = {
      {.name = "a", .product = "v^3", .unit = "N s^3/m^3", .value = -7700.0, .std = 12.0, .share = 0.7},
      {.name = "b", .product = "x v", .unit = "N s/m^2", .value = 3760.0, .std = 2.0, .share = 0.3}};
  term.seen = {{"x", "mm", 0.0, 4.3}, {"v", "mm/s", -61.0, 74.0}};
  term.rmse_before = 0.43, term.rmse_calibrated = 0.42, term.rmse_after = 0.011, term.gap_closed = 0.998;
  term.meaning = "a drag of another kind";
  term.rivals = {"a v |v|"};
  f.proposed = term;
  f.model_proposed = f.model_before + "[term.proposed]\n";
  f.sentence = verdict_sentence(f);
  return f;
}

TEST(GapSentence, NamesTheRivalsThatTheRunsLeave) {
  GapFinding f = example_effect();
  f.effects.resize(1);
  f.effects[0].probability = 0.55;
  f.effects[0].confused_with = {{"lugre_friction", 0.41}, {"backlash", 0.02}};
  EXPECT_NE(verdict_sentence(f).find("do not tell it (0.55) from LuGre friction (0.41)."), std::string::npos)
      << verdict_sentence(f);
  f.effects[0].probability = 0.97;
  EXPECT_EQ(verdict_sentence(f).find("do not tell"), std::string::npos);
}

TEST(GapSentence, SaysWhichRunsDifferAndKeepsTheNamesOfNumbers) {
  GapFinding f = example_unexplained();
  f.rejected = {
      .effects = {"another value of c_s"}, .gap_closed = 0.7, .rmse_after = 0.1, .objections = {"a reason"}};
  EXPECT_NE(verdict_sentence(f).find("The nearest, another value of c_s,"), std::string::npos)
      << verdict_sentence(f);
  f.rmse_before = 12.69, f.noise_floor = 12.70;
  EXPECT_EQ(verdict_sentence(f).find("On the runs that were held out"), 0U) << verdict_sentence(f);
}

TEST(GapProposal, IsSaidAsAnEquationAndNotAsAName) {
  const GapFinding f = example_proposed();
  for (const std::string& text : {f.sentence, gap_console(f)}) {
    EXPECT_NE(text.find("Proposed, not a name"), std::string::npos) << text;
    EXPECT_NE(text.find("F = -7700 v^3 + 3760 x v"), std::string::npos) << text;
  }
  EXPECT_LE(lines(gap_console(f)), 30U);
  const std::string html = gap_html(f);
  for (const char* part : {"<h2>Proposed term</h2>", "F = -7700 v^3 + 3760 x v", "N s^3/m^3",
                           "x from 0 to 4.3 mm and v from -61 to 74 mm/s", "It may be a drag of another kind",
                           "Nearly as little is left by: a v |v|", "[term.proposed]",
                           "The change that --accept makes", "were not checked with the proposed term"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
  EXPECT_EQ(gap_html(example_unexplained()).find("Proposed term"), std::string::npos);
}

TEST(GapProposal, SaysWhatItsLettersStandFor) {
  GapFinding f = example_proposed();
  f.proposed->exponent = 0.482, f.proposed->exponent_std = 0.004;
  f.proposed->period_mm = 3.2, f.proposed->period_std = 0.01;
  f.proposed->memory_s = 0.25, f.proposed->memory_std = 0.02;
  const std::string html = gap_html(f);
  for (const char* part : {", n = 0.482, k = 2π/3.2 mm, q forgotten within 0.25 s</strong>",
                           "n is 0.4820 ± 0.0040", "k is 2π over a period of 3.200 ± 0.010 mm"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
  const ordered_json term = ordered_json::parse(gap_json(f))["proposed"];
  EXPECT_EQ(term["exponent"], 0.482);
  EXPECT_EQ(term["period_mm"], 3.2);
  const ordered_json plain = ordered_json::parse(gap_json(example_proposed()))["proposed"];
  EXPECT_TRUE(plain["exponent"].is_null());
  EXPECT_TRUE(plain["period_std_mm"].is_null());
}

TEST(GapProposal, IsAFieldOfItsOwnInJson) {
  const ordered_json gap = ordered_json::parse(gap_json(example_proposed()));
  expect_interface(gap);
  EXPECT_EQ(gap["verdict"], "unexplained");
  EXPECT_TRUE(gap["effects"].empty());
  const ordered_json& term = gap["proposed"];
  EXPECT_EQ(keys(term), (Names{"name", "expression", "coefficients", "memory_s", "memory_std_s", "exponent",
                               "exponent_std", "period_mm", "period_std_mm", "seen", "rmse_mm", "gap_closed",
                               "meaning", "rivals"}));
  EXPECT_EQ(term["coefficients"][1], (ordered_json{{"name", "b"},
                                                   {"product", "x v"},
                                                   {"unit", "N s/m^2"},
                                                   {"value", 3760.0},
                                                   {"std", 2.0},
                                                   {"share_of_force", 0.3}}));
  EXPECT_TRUE(term["memory_s"].is_null());
  EXPECT_TRUE(ordered_json::parse(gap_json(example_unexplained()))["proposed"].is_null());
}

TEST(GapProposal, LeavesTheModelAsGivenAndOneWithTheTermBesideIt) {
  const ScratchFolder folder;
  const GapFinding f = example_proposed();
  save_gap(f, folder.path());
  EXPECT_EQ(file_content(folder.path() / "model.toml"), f.model_after);
  EXPECT_EQ(file_content(folder.path() / "proposed.toml"), f.model_proposed);
}

TEST(GapJson, BearsNamesThatAreNotUtf8) {
  GapFinding f = example_effect();
  f.held_out_runs = {"ramp-\xE9"};
  EXPECT_EQ(ordered_json::parse(gap_json(f))["held_out_runs"][0], "ramp-\uFFFD");
}

TEST(GapReport, LeavesFourWholeFilesAndNothingElse) {
  const ScratchFolder folder;
  save_gap(example_effect(), folder.path() / "made" / "on the way");
  Names names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "made" / "on the way"))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (Names{"gap.json", "model.toml", "report.html", "signals.csv"}));
  EXPECT_EQ(file_content(folder.path() / "made" / "on the way" / "model.toml"), example_effect().model_after);
  EXPECT_EQ(file_content(folder.path() / "made" / "on the way" / "gap.json"), gap_json(example_effect()));
}

TEST(GapReport, RefusesAFolderThatCannotBeMade) {
  const ScratchFolder folder;
  std::ofstream(folder.path() / "taken") << "a file";
  EXPECT_THROW(save_gap(example_effect(), folder.path() / "taken"), ConfigError);
}

using enum DiffKind;
using Diff = std::vector<DiffLine>;

TEST(LineDiff, FindsWhatChangedInSmallTexts) {
  EXPECT_EQ(line_diff("", ""), Diff{});
  EXPECT_EQ(line_diff("a\nb\n", "a\nb\n"), (Diff{{Same, "a"}, {Same, "b"}}));
  EXPECT_EQ(line_diff("a\nb\nc\n", "a\nx\nc\n"),
            (Diff{{Same, "a"}, {Removed, "b"}, {Added, "x"}, {Same, "c"}}));
  EXPECT_EQ(line_diff("a\n", "a\n\nb"), (Diff{{Same, "a"}, {Added, ""}, {Added, "b"}}));
  EXPECT_EQ(line_diff("a\nb\n", ""), (Diff{{Removed, "a"}, {Removed, "b"}}));
  EXPECT_EQ(line_diff("a\r\n", "a\n"), (Diff{{Same, "a"}}));
}

TEST(LineDiff, KeepsBothTextsAndAsManyCommonLinesAsThereAre) {
  const std::string before = "a\nb\nc\na\nb\nb\na", after = "c\nb\na\nb\na\nc";
  std::string old_text, new_text;
  int same = 0;
  for (const DiffLine& line : line_diff(before, after)) {
    if (line.kind != Added) old_text += line.text + "\n";
    if (line.kind != Removed) new_text += line.text + "\n";
    same += line.kind == Same;
  }
  EXPECT_EQ(old_text, before + "\n");
  EXPECT_EQ(new_text, after + "\n");
  EXPECT_EQ(same, 4);  // Myers 1986: ABCABBA and CBABAC share four letters
}

TEST(GapWords, NamesAreWordsForPeople) {
  EXPECT_EQ(readable_name("coulomb_friction"), "Coulomb friction");
  EXPECT_EQ(readable_name("lugre_friction"), "LuGre friction");
  EXPECT_EQ(readable_name("load_dependent_friction"), "load-dependent friction");
  EXPECT_EQ(regime_label("after_reversal"), "after a polarity reversal");
  EXPECT_EQ(regime_label("run:ramp_50g"), "in run ramp_50g");
  EXPECT_EQ(regime_label("after_a_hiccup"), "after a hiccup");  // unknown ones still read
  EXPECT_EQ(effect_quantity("speed_mm_s").unit, "mm/s");
  EXPECT_EQ(effect_quantity("coulomb_N_per_mm").unit, "N/mm");
  EXPECT_EQ(effect_quantity("viscous_N_s_per_m_per_mm").unit, "N s/m/mm");
  EXPECT_EQ(effect_quantity("viscous_N_s_per_m_per_mm").label, "viscous");
  EXPECT_EQ(effect_quantity("coefficient_N_s2_per_m2").unit, "N s²/m²");
  EXPECT_EQ(effect_quantity("rate_um_per_s").unit, "µm/s");
  EXPECT_EQ(effect_quantity("gain").unit, "");
  EXPECT_EQ(estimate_text(0.0300, 0.0010), "0.0300 ± 0.0010");
  EXPECT_EQ(estimate_text(6.9123, 0.21), "6.91 ± 0.21");
  EXPECT_EQ(estimate_text(140.2, kNan), "140");
  EXPECT_EQ(interval_text(10, 1), "8.0 to 12.0");
  EXPECT_EQ(interval_text(10, 0), "–");
}

TEST(GapCandidates, AreReadByRoundChosenFirstThenFittedByProbabilityThenByScore) {
  using enum CandidateKind;
  const std::vector<GapCandidate> ranked =
      ranked_candidates({{"late", Effect, 2, 0.9, true, 0.01, 0.99, true},
                         {"slight", Effect, 1, 0.1, false},
                         {"likely", Effect, 1, 0.2, true, 0.02, 0.6, false},
                         {"worse", Effect, 1, 0.3, true, 0.03, 0.0, false},
                         {"promising", Effect, 1, 0.8, false},
                         {"better", Effect, 1, 0.1, true, 0.02, 0.0, false},
                         {"taken", Parameter, 1, 0.2, true, 0.02, 0.3, true}});
  Names order;
  for (const GapCandidate& candidate : ranked) order.push_back(candidate.name);
  EXPECT_EQ(order, (Names{"taken", "likely", "better", "worse", "promising", "slight", "late"}));
}

TEST(GapConsole, SaysVerdictRmseWhereCandidatesAndNextExperiment) {
  const std::string text = gap_console(example_effect());
  std::size_t at = 0;
  for (const char* part :
       {"Effect found. Plate A sticks", "0.130 mm before, 0.011 mm after, 0.010 mm noise", "MARGIN LOST",
        "after a polarity reversal", "Coulomb friction", "chosen", "Next experiment: slow triangle"}) {
    at = text.find(part, at);
    ASSERT_NE(at, std::string::npos) << part << "\n" << text;
  }
}

TEST(GapConsole, StaysWithinThirtyLinesAndCannotMoveTheCursor) {
  GapFinding f = example_effect();
  for (int i = 0; i < 50; ++i) {
    f.sentence += " and so on, at length, for whoever has the patience";
    f.next.sentence += " and so on, at length";
    f.where.push_back(f.where[0]);
    f.candidates.push_back(f.candidates[0]);
    f.margins.push_back(f.margins[1]);
    f.margins.back().plan = "a plan with a long name \033[2J\n that goes on and on \n and on";
  }
  f.where[0].name = f.candidates[0].name = "\033[2J\n";
  const std::string text = gap_console(f);
  EXPECT_LE(lines(text), 30U) << text;
  EXPECT_EQ(text.find('\033'), std::string::npos);
  for (const GapFinding& finding : {example_no_gap(), example_unexplained(), GapFinding{}})
    EXPECT_LE(lines(gap_console(finding)), 30U);
}

}  // namespace
}  // namespace biopsy::report
