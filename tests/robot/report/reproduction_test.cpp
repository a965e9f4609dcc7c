#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "robot/report/study/paper_score.hpp"
#include "robot/report/study/reproduction_report.hpp"
#include "tests/count_of.hpp"
#include "tests/robot/report/reproduction_example.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::report {
namespace {

TEST(PaperScore, CountsNumbersAndTrendsApartAndShownRowsNowhere) {
  const PaperScore score = score_of(example_reproduction());
  EXPECT_EQ(score.numbers, 5U);  // two numbers, two bounds, one strain
  EXPECT_EQ(score.numbers_ok, 3U);
  EXPECT_EQ(score.trends, 2U);
  EXPECT_EQ(score.trends_ok, 1U);
  EXPECT_EQ(score.bounds, 2U);
  EXPECT_EQ(score.bounds_ok, 1U);
  EXPECT_EQ(
      score_sentence(score),
      "3 of 5 of the paper's numbers within their band (2 of 3 to be met, 1 of 2 bounds), trends 1 of 2");
}

TEST(PaperScore, AsksForNineNumbersOfTenAndForEveryTrend) {
  EXPECT_TRUE((PaperScore{40, 36, 20, 20}.enough_numbers()));
  EXPECT_FALSE((PaperScore{40, 35, 20, 20}.enough_numbers())) << "trends do not make up for numbers";
  EXPECT_TRUE((PaperScore{40, 35, 20, 20}.every_trend()));
  EXPECT_FALSE((PaperScore{40, 40, 20, 19}.every_trend())) << "nor numbers for trends";
}

TEST(ReproductionHtml, TellsOfEveryMissUnderABarThatIsPassed) {
  Reproduction r;
  r.figures.emplace_back().number = "1";
  for (int n = 0; n < 10; ++n) {
    PaperRow row;
    row.kind = RowKind::Number;
    row.ok = n > 0;
    r.figures.back().rows.push_back(row);
  }
  const std::string html = reproduction_html(r);
  EXPECT_EQ(count_of(html, "✓ Passed: "), 2U);
  EXPECT_NE(html.find("■ 1 of 10 missed"), std::string::npos);
  r.figures.back().rows.front().ok = true;
  EXPECT_EQ(reproduction_html(r).find(" missed; each"), std::string::npos);
}

TEST(PaperScore, CountsClosedFormsApartFromThePapersNumbers) {
  PaperScore score;
  PaperRow row;
  row.figure = "2", row.kind = RowKind::AtMost, row.ok = true;
  score.add(row);
  EXPECT_EQ(score.numbers, 0U);
  EXPECT_EQ(score_sentence(score),
            "0 of 0 of the paper's numbers within their band, trends 0 of 0, closed forms 1 of 1");
}

// Two of seven rows that the leakage model meets too, and one figure held out.
Reproduction compared_example() {
  Reproduction r = example_reproduction();
  for (PaperFigure& figure : r.figures)
    for (PaperRow& row : figure.rows) {
      if (row.kind == RowKind::Shown) continue;
      row.leakage_ok = row.quantity == "overshoot" || row.quantity == "level rises from 0.2 to 2 Hz";
      if (row.figure == "8b") row.held_out = HeldOutValue{71.0, false};
    }
  r.fitted = FittedTo{21, 20, 47, "biopsy calibrate --leave-one-out"};
  return r;
}

TEST(PaperScore, SaysWhatWasFittedWhatIsPredictedAndWhatTheLeakageModelMeetsAnyway) {
  const std::vector<std::string> remarks = score_remarks(compared_example());
  ASSERT_EQ(remarks.size(), 3U);
  EXPECT_EQ(remarks[0], "Fitted: 21 unknowns to 20 numbers and 47 statements of the paper.");
  EXPECT_NE(remarks[1].find("0 of 1 numbers and 0 of 0 statements met (0 %)"), std::string::npos)
      << remarks[1];
  EXPECT_NE(remarks[2].find(
                "1 of 5 numbers and 1 of 2 statements; of the 5 rows that it misses, this model meets 2"),
            std::string::npos)
      << remarks[2];
  EXPECT_NE(score_remarks(example_reproduction())[0].find("not known here"), std::string::npos);
  const std::string html = reproduction_html(compared_example());
  EXPECT_EQ(count_of(html, "<td>met too</td>"), 2U);
  EXPECT_NE(html.find("■ 71.0 %"), std::string::npos);
  const auto parsed = nlohmann::json::parse(reproduction_json(compared_example()));
  EXPECT_EQ(parsed["score"]["leakage_numbers"]["ok"], 1);
  EXPECT_EQ(parsed["score"]["held_out_numbers"]["of"], 1);
  EXPECT_EQ(parsed["fitted"]["unknowns"], 21);
  EXPECT_TRUE(parsed["rows"][0]["held_out"].is_null());
}

TEST(PaperScore, ThreeDigitsThatCountWhateverTheSize) {
  EXPECT_EQ(three_digits(0.08014), "0.0801");
  EXPECT_EQ(three_digits(48.13), "48.1");
  EXPECT_EQ(three_digits(5234.0), "5234");
  EXPECT_EQ(three_digits(3.2e-9), "3.2e-09");
  EXPECT_EQ(three_digits(0.0), "0");
  EXPECT_EQ(three_digits(std::numeric_limits<double>::quiet_NaN()), "–");
}

TEST(ReproductionHtml, SaysTheScoreBeforeAnyPictureAndTheFindingsAfterAllTables) {
  const std::string html = reproduction_html(example_reproduction());
  const std::size_t score =
      html.find("3 of 5 of the paper&#39;s numbers within their band (2 of 3 to be met");
  ASSERT_NE(score, std::string::npos);
  EXPECT_LT(score, html.find("<figure"));
  EXPECT_GT(html.find("Findings, for the gap workflow"), html.rfind("</table>"));
}

TEST(ReproductionHtml, EveryRowHasItsLineMissesRedWithTheReasonAndShownOnesGrey) {
  const Reproduction r = example_reproduction();
  const std::string html = reproduction_html(r);
  EXPECT_EQ(count_of(html, "<td class=\"quantity\">"), 8U);
  EXPECT_EQ(count_of(html, "<tr class=\"missed\"><td class=\"quantity\">"), 3U);
  EXPECT_EQ(count_of(html, "<tr class=\"shown\">"), 1U);
  EXPECT_EQ(count_of(html, "■ missed"), 3U);
  EXPECT_NE(html.find("tr.missed td { color: #b00020; }"), std::string::npos);
  for (const PaperRow* missed : missed_rows(r)) EXPECT_FALSE(missed->note.empty());
  EXPECT_NE(html.find("the film creeps &amp; the model does not"), std::string::npos);
  EXPECT_EQ(html.find("<50 um>"), std::string::npos);
}

TEST(ReproductionHtml, DrawsEachPanelOnceBesideItsTable) {
  const std::string html = reproduction_html(example_reproduction());
  EXPECT_EQ(count_of(html, "class=\"panel\""), 3U);
  EXPECT_EQ(count_of(html, "<section class=\"figure-section\">"), 3U);
}

TEST(ReproductionHtml, GivesTheGapCommandOfEachMissedFigureAsAShellTakesIt) {
  const std::string html = reproduction_html(example_reproduction());
  EXPECT_EQ(count_of(html, "biopsy gap "), 1U);  // only Fig. 7a has misses
  EXPECT_NE(
      html.find(
          "biopsy gap measured/figure-7a --model &#39;sim/models/my stage.toml&#39; --out out/gap-figure-7a"),
      std::string::npos);
}

TEST(ReproductionHtml, LoadsNothingAndRunsNoScriptWhateverTheTextSays) {
  Reproduction r = example_reproduction();
  r.model = "<script>alert(1)</script>";
  r.figures[0].title = "<img src=x>";
  r.figures[0].rows[1].note = "\"><a href='x'>";
  r.figures[0].panels[0].title = "</title><script>";
  const std::string html = reproduction_html(r);
  for (const char* outside : {"<script", "<link", "<img", "<a ", "url(", "@import"})
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
}

TEST(ReproductionHtml, SaysWhichPartOfTheBarIsMissed) {
  Reproduction r = example_reproduction();
  for (PaperFigure& figure : r.figures)
    for (PaperRow& row : figure.rows) row.ok = row.kind != RowKind::Trend;
  const std::string html = reproduction_html(r);
  EXPECT_NE(html.find("✓ Passed: 90 % of the numbers within their band.<"), std::string::npos);
  EXPECT_NE(html.find("■ Not passed: every trend as stated"), std::string::npos);
  EXPECT_NE(html.find("■ 2 of 2 missed"), std::string::npos);
}

TEST(ReproductionHtml, WithoutAMissThereIsNoFinding) {
  Reproduction r = example_reproduction();
  for (PaperFigure& figure : r.figures)
    for (PaperRow& row : figure.rows) row.ok = true;
  const std::string html = reproduction_html(r);
  EXPECT_EQ(html.find("Findings"), std::string::npos);
  EXPECT_EQ(count_of(html, "✓ Passed: "), 2U);
  EXPECT_EQ(html.find(" missed; each"), std::string::npos);
}

TEST(ReproductionJson, HasEveryRowWithItsFieldsAndTheMissesAsFindings) {
  Reproduction r = example_reproduction();
  r.figures[1].rows[0].ours = std::numeric_limits<double>::quiet_NaN();
  const auto parsed = nlohmann::json::parse(reproduction_json(r));
  ASSERT_EQ(parsed["rows"].size(), 8U);
  for (const auto& row : parsed["rows"])
    for (const char* field : {"figure", "quantity", "unit", "kind", "paper", "ours", "band", "ok", "note"})
      EXPECT_TRUE(row.contains(field)) << field;
  EXPECT_EQ(parsed["rows"][0]["paper"], 0.077);
  EXPECT_EQ(parsed["rows"][0]["ours"], 0.0801);
  EXPECT_EQ(parsed["rows"][0]["band"], 0.2);
  EXPECT_EQ(parsed["rows"][0]["ok"], true);
  EXPECT_TRUE(parsed["rows"][6]["ours"].is_null());
  EXPECT_EQ(parsed["findings"].size(), 3U);
  EXPECT_EQ(parsed["findings"][0]["note"], "the film creeps & the model does not");
  EXPECT_EQ(parsed["seconds"], 12.34);
}

TEST(ReproductionConsole, PlainTextHasNoEscapesColouredTextTheSameWords) {
  const std::string grey = reproduction_console(example_reproduction(), false);
  const std::string coloured = reproduction_console(example_reproduction(), true);
  EXPECT_EQ(grey.find('\033'), std::string::npos);
  EXPECT_NE(coloured.find("\033[1;31m7a"), std::string::npos);
  EXPECT_NE(grey.find("spring too soft"), std::string::npos);
  EXPECT_NE(grey.find("(2 of 3 to be met, 1 of 2 bounds), trends 1 of 2\n"), std::string::npos);
}

TEST(ReproductionReport, LeavesAPageAndAJsonFile) {
  const ScratchFolder folder;
  save_reproduction(example_reproduction(), folder / "out");
  EXPECT_TRUE(file_content(folder / "out/report.html").ends_with("</html>\n"));
  EXPECT_TRUE(nlohmann::json::accept(file_content(folder / "out/reproduce.json")));
}

}  // namespace
}  // namespace biopsy::report
