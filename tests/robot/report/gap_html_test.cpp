#include <gtest/gtest.h>

#include <cctype>
#include <limits>

#include "robot/report/gap/gap_report.hpp"
#include "tests/count_of.hpp"
#include "tests/robot/report/gap_example.hpp"
#include "tests/robot/report/html_balance.hpp"

namespace biopsy::report {
namespace {

bool holds(const std::string& text, const std::string& what) {
  return text.find(what) != std::string::npos;
}

std::vector<GapFinding> every_verdict() {
  return {example_effect(), example_parameter(), example_no_gap(), example_unexplained(), GapFinding{}};
}

TEST(GapHtml, ClosesEveryTagLoadsNothingAndRunsNoScriptWhateverTheVerdict) {
  for (const GapFinding& finding : every_verdict()) {
    const std::string html = gap_html(finding);
    EXPECT_EQ(imbalance(html), "");
    for (const char* outside : {"<script", "<link", "<img", "src=", "href=", "url(", "@import"})
      EXPECT_FALSE(holds(html, outside)) << outside;
  }
}

TEST(GapHtml, SaysTheVerdictBeforeAnyPictureAndThePicturesBeforeAnyTable) {
  const std::string html = gap_html(example_effect());
  const std::size_t verdict = html.find("Plate A sticks: Coulomb friction"), figure = html.find("<figure");
  const std::size_t overlay = html.find("<h2>Before and after</h2>"), table = html.find("<table");
  EXPECT_LT(verdict, figure);
  EXPECT_LT(figure, overlay);
  EXPECT_LT(overlay, table);
  EXPECT_NE(table, std::string::npos);
}

TEST(GapHtml, BadgeNamesEachVerdictInItsOwnWord) {
  EXPECT_TRUE(holds(gap_html(example_effect()), "class=\"badge effect\">● Effect found<"));
  EXPECT_TRUE(holds(gap_html(example_parameter()), "class=\"badge parameter\">◆ Parameter off<"));
  EXPECT_TRUE(holds(gap_html(example_no_gap()), "class=\"badge no_gap\">✓ No gap<"));
  EXPECT_TRUE(holds(gap_html(example_unexplained()), "class=\"badge unexplained\">? Unexplained<"));
}

TEST(GapHtml, ALostMarginIsARedFindingOnTheFirstPageAndHeldOnesAreNot) {
  GapFinding finding = example_effect();
  const std::string lost = gap_html(finding);
  const std::size_t alarm = lost.find("overshoot reaches 0.118 mm with the new model; the limit is 0.100 mm");
  ASSERT_NE(alarm, std::string::npos);
  EXPECT_LT(alarm, lost.find("<figure"));
  EXPECT_TRUE(holds(lost, "class=\"verdict gap unsafe\""));
  for (MarginChange& margin : finding.margins) margin.ok = true;
  const std::string held = gap_html(finding);
  EXPECT_TRUE(holds(held, "all 3 hold with the new model"));
  EXPECT_FALSE(holds(held, "class=\"alarm\"")) << "red without a reason";
  finding.margins.clear();
  EXPECT_TRUE(holds(gap_html(finding), "were not rechecked"));
}

TEST(GapHtml, ParametersHaveIntervalsInReadableUnits) {
  const std::string effect = gap_html(example_effect());
  EXPECT_TRUE(holds(effect, "0.0300 ± 0.0010"));
  EXPECT_TRUE(holds(effect, "0.0280 to 0.0320"));
  const std::string parameter = gap_html(example_parameter());  // 104e-6 m, std 0.9e-6 m
  EXPECT_TRUE(holds(parameter, "104.00 ± 0.90</td><td class=\"n\">102.24 to 105.76</td><td>µm</td>"));
  EXPECT_TRUE(holds(parameter, "<td class=\"n\">+8.0 %</td>"));  // K: 0.064 / 0.80
}

TEST(GapHtml, CandidatesAreRankedChosenFirstAndTheUnfittedSaySo) {
  const std::string html = gap_html(example_effect());
  const std::string tried = html.substr(html.find("<h2>Candidates</h2>"));
  EXPECT_EQ(count_of(tried, "<tr class=\"chosen\">"), 1U);
  EXPECT_LT(tried.find("<code>coulomb_friction"), tried.find("<code>stribeck_friction"));
  EXPECT_LT(tried.find("<code>stribeck_friction"), tried.find("backlash"));
  EXPECT_EQ(count_of(tried, ">ruled out by the score test</td>"), 5U);  // of 8; the others in one sentence
  EXPECT_TRUE(
      holds(tried, "Also ruled out by the score test: pouch creep, charge retention and time constant"));
  EXPECT_TRUE(holds(tried, "Round 2: what to add to the choice so far"));
  EXPECT_TRUE(holds(tried, "None of them met the criterion to enter."));
}

TEST(GapHtml, SaysWhatCouldNotBeToldApartAndWhatWould) {
  GapFinding finding = example_effect();
  EXPECT_TRUE(holds(gap_html(finding), "they do not exclude Stribeck friction (0.02)"));
  EXPECT_TRUE(holds(gap_html(finding),
                    "The next experiment should be: slow triangle. It separates Coulomb friction and "
                    "Stribeck friction."));
  EXPECT_TRUE(holds(gap_html(finding), "4.3 times the scatter of a reading"));
  finding.effects[0].probability = 0.52;
  finding.effects[0].confused_with[0].probability = 0.48;
  EXPECT_TRUE(holds(gap_html(finding), "is indistinguishable from Stribeck friction (0.48)"));
  finding.effects[0].confused_with[0].name = "c_s";
  EXPECT_TRUE(holds(gap_html(finding), "is indistinguishable from viscous damping of the slider (0.48)"));
  finding.next.sentence.clear();
  EXPECT_TRUE(holds(gap_html(finding), "differ by 0.043 mm RMS, 4.3 times the noise"));
  finding.effects[0].confused_with.clear();
  finding.next = {"", {}, 0.0, "There are no two explanations to tell apart."};
  EXPECT_TRUE(holds(gap_html(finding), "There are no two explanations to tell apart."));
}

TEST(GapHtml, ShowsTheModelChangeLineByLine) {
  const std::string html = gap_html(example_parameter());
  EXPECT_TRUE(holds(html, "<span class=\"removed\">− K = 0.80</span>"));
  EXPECT_TRUE(holds(html, "<span class=\"added\">+ K = { value = 0.864, std = 0.0021 }</span>"));
  EXPECT_EQ(count_of(html, "<span class=\"removed\">"), 1U);
  EXPECT_TRUE(holds(gap_html(example_no_gap()), "The model is unchanged."));
}

TEST(GapHtml, NoGapReadsWellWithoutEmptySectionsOrFiguresThatMeanNothing) {
  const std::string html = gap_html(example_no_gap());
  for (const char* absent : {"Gap closed", "<h2>Candidates", "Effect found", "not rechecked",
                             "Indistinguishable", "parameters that changed", "class=\"alarm\""})
    EXPECT_FALSE(holds(html, absent)) << absent;
  EXPECT_TRUE(holds(html, "nothing is missing"));
  EXPECT_TRUE(holds(html, "<h2>Measurement and model</h2>"));
}

TEST(GapHtml, UnexplainedDrawsTheResidualAgainstWhatItDependsOnMost) {
  const std::string html = gap_html(example_unexplained());
  EXPECT_TRUE(holds(html, "depends most on position"));
  EXPECT_TRUE(holds(html, "accounts for 88 % of the residual&#39;s variance"));
  EXPECT_TRUE(holds(html, "<title>Mean residual against position</title>"));
  EXPECT_TRUE(holds(html, "<title>Mean residual against speed</title>"));
  EXPECT_TRUE(holds(html, "estimated from the data"));
  EXPECT_TRUE(holds(html, "rehearsals with it do not include what is missing"));
}

TEST(GapHtml, ACandidateThatHelpedButWasNotAdoptedIsNotCalledChosen) {
  GapFinding finding = example_unexplained();
  finding.candidates[0].chosen = true;
  const std::string html = gap_html(finding);
  EXPECT_TRUE(holds(html, "the best, not adopted"));
  EXPECT_FALSE(holds(html, "✓ chosen"));
}

TEST(GapHtml, SaysSoWhereTheErrorIsEverywhere) {
  GapFinding finding = example_effect();
  finding.where[0].share_of_excess_error = 1.1 * finding.where[0].share_of_time;
  EXPECT_TRUE(holds(gap_html(finding), "spread over all situations"));
}

TEST(GapHtml, ShowsMarkupInEveryTextFromAFileAsText) {
  GapFinding f = example_effect();
  int planted = 0;
  const auto hostile = [&] { return "\"'><script>alert(" + std::to_string(planted++) + ")</script>&amp;"; };
  for (std::string* text : {&f.sentence,
                            &f.dataset,
                            &f.effects[0].name,
                            &f.effects[0].sentence,
                            &f.effects[0].parameters[0].name,
                            &f.effects[0].confused_with[0].name,
                            &f.where[0].name,
                            &f.regime_names[0],
                            &f.candidates[0].name,
                            &f.traces[0].run,
                            &f.traces[2].run,
                            &f.next.name,
                            &f.next.separates[0],
                            &f.next.sentence,
                            &f.margins[0].plan,
                            &f.margins[0].quantity,
                            &f.margins[0].unit,
                            &f.margins[1].plan,
                            &f.held_out_runs[0],
                            &f.training_runs[0],
                            &f.warnings[0],
                            &f.model_after})
    *text = hostile();
  f.parameters_changed = {{hostile(), 1, 2, 0.1}};
  f.shapes = example_unexplained().shapes;
  f.shapes[0].quantity = hostile();
  f.shapes[0].unit = hostile();
  const std::string html = gap_html(f);
  EXPECT_FALSE(holds(html, "<script"));
  EXPECT_EQ(imbalance(html), "");
  for (int i = 0; i < planted; ++i)
    EXPECT_TRUE(holds(html, "alert(" + std::to_string(i) + ")")) << "text " << i << " is missing";
}

TEST(GapHtml, NeverShowsNanOrInfinityAndBearsBrokenTraces) {
  GapFinding f = example_effect();
  f.rmse_after = f.gap_closed = f.noise_floor = f.effects[0].probability = kNan;
  f.effects[0].parameters[0].std = f.candidates[0].probability = f.where[0].share_of_time = kNan;
  f.margins[0].limit = 0;
  f.where[1].rmse_before = 0;
  f.traces[0].before[5] = f.traces[0].measured[7] = kNan;
  f.traces[1].after.clear();
  f.traces[2].regime.clear();
  f.traces.push_back({"short", true, {0.0, 1.0}, {}, {0.0}, {}, {}, {9}});
  const std::string html = gap_html(f);
  for (const char* token : {">nan", " nan", "\"nan", ">inf ", " inf", "\"inf", "-nan", "-inf"})
    EXPECT_FALSE(holds(html, token)) << token;
}

TEST(GapHtml, GivesEveryPictureATextForThoseWhoCannotSeeIt) {
  for (const GapFinding& finding : every_verdict()) {
    const std::string html = gap_html(finding);
    EXPECT_EQ(count_of(html, "role=\"img\""), count_of(html, "</title>") - 1);  // one title is the page's
  }
}

}  // namespace
}  // namespace biopsy::report
