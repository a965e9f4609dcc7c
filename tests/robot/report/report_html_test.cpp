#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "robot/report/procedure/report.hpp"
#include "tests/count_of.hpp"
#include "tests/robot/report/example_run.hpp"
#include "tests/robot/report/html_balance.hpp"

namespace biopsy::report {
namespace {

std::vector<std::string> attribute_values(const std::string& html, const std::string& name) {
  std::vector<std::string> values;
  const std::string start = " " + name + "=\"";
  for (std::size_t at = html.find(start); at != std::string::npos; at = html.find(start, at + 1)) {
    const std::size_t from = at + start.size();
    values.push_back(html.substr(from, html.find('"', from) - from));
  }
  return values;
}

std::vector<RunRecord> every_kind() {
  RunRecord undrawn = example_run();  // pictures without geometry
  undrawn.planning_geometry.reset();
  for (StepResult& stage : undrawn.steps) stage.geometry.reset();
  return {example_run(), example_refusal(), example_stop(), undrawn, RunRecord{}};
}

TEST(ReportHtml, ClosesEveryTagInOrder) {
  for (const RunRecord& record : every_kind()) EXPECT_EQ(imbalance(report_html(record)), "");
}

TEST(ReportHtml, SaysThatFaultsWerePutIn) {
  RunRecord record = example_run();
  EXPECT_EQ(report_html(record).find("Put in"), std::string::npos);
  record.faults = {{.signal = "depth",
                    .kind = "offset",
                    .began_s = 2.5,
                    .detected_by = "H-10 depth",
                    .detected_after_ms = 7.0},
                   {.signal = "drive", .kind = "held"}};
  const std::string html = report_html(record);
  EXPECT_EQ(imbalance(html), "");
  EXPECT_NE(html.find("Put in: depth offset, drive held (never began)."), std::string::npos);
  EXPECT_NE(html.find("Faults put in"), std::string::npos);
  EXPECT_NE(html.find("H-10 depth"), std::string::npos);
}

TEST(ReportHtml, LoadsNothingFromANetworkAndRunsNoScript) {
  for (const RunRecord& record : every_kind()) {
    const std::string html = report_html(record);
    for (const char* attribute : {"src", "href", "xlink:href", "srcset", "action", "data"})
      for (const std::string& value : attribute_values(html, attribute))
        EXPECT_TRUE(value.starts_with("data:image/png;base64,")) << attribute << "=" << value.substr(0, 60);
    EXPECT_EQ(html.find("url("), std::string::npos);
    EXPECT_EQ(html.find("@import"), std::string::npos);
    EXPECT_EQ(html.find("<script"), std::string::npos);
    EXPECT_EQ(html.find("<link"), std::string::npos);
  }
}

// Every text that can come from a file or a person, each with markup of its own number.
std::pair<RunRecord, int> hostile_run() {
  RunRecord record = example_run();
  int planted = 0;
  const auto hostile = [&] { return "\"'><script>alert(" + std::to_string(planted++) + ")</script>&amp;"; };
  SeriesIdentity& series = record.series;
  for (std::string* text :
       {&record.title, &series.patient_name, &series.patient_id, &series.study_uid, &series.series_uid,
        &series.modality, &series.description, &series.date, &record.image_source, &record.layer_at_tip})
    *text = hostile();
  record.image_warnings = {hostile()};
  record.plan->layers[1].name = hostile();
  record.steps[0].step.why = hostile();
  record.steps[0].layer_at_tip = hostile();
  record.steps[0].check->reason = hostile();
  record.limits[0].name = hostile();
  record.limits[0].unit = hostile();
  record.trips = {{1.0, StopCategory::C1Ramp, hostile()}};
  record.provenance = {{hostile(), hostile()}};
  return {record, planted};
}

TEST(ReportHtml, ShowsMarkupInPatientNamesAndEveryOtherTextAsText) {
  const auto [record, planted] = hostile_run();
  const std::string html = report_html(record);
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(imbalance(html), "");
  for (int number = 0; number < planted; ++number)
    EXPECT_NE(html.find("&lt;script&gt;alert(" + std::to_string(number) + ")&lt;/script&gt;&amp;amp;"),
              std::string::npos)
        << "text " << number << " is missing";
  RunRecord refused = example_refusal();
  refused.refusal = refused.remedy = "<script>alert(1)</script>";
  EXPECT_EQ(count_of(report_html(refused), "&lt;script&gt;"), 2U);
}

TEST(ReportHtml, SaysTheVerdictBeforeAnythingElse) {
  const std::string html = report_html(example_run());
  const std::size_t verdict =
      html.find("Completed: needle tip at 3.51 mm in liver; image says 3.49 ± 0.06 mm; target 3.50 mm.");
  ASSERT_NE(verdict, std::string::npos);
  EXPECT_LT(verdict, html.find("<table"));
  EXPECT_LT(verdict, html.find("<figure"));
}

TEST(ReportHtml, RefusalAndStopSayWhyAndWhatToDo) {
  EXPECT_NE(report_html(example_refusal())
                .find("Refused: the target lies 4.2 mm beside the needle&#39;s axis; 0.5 mm is allowed. What "
                      "to do: Move "
                      "the robot or choose a target within 0.5 mm of the axis."),
            std::string::npos);
  EXPECT_NE(
      report_html(example_stop()).find("Stopped: the laser lost its target for 20 ms. What to do: Clean"),
      std::string::npos);
}

TEST(ReportHtml, RaisesAnAlarmWhenACompletedRunIsNotConfirmedByItsLastImage) {
  EXPECT_EQ(report_html(example_run()).find("Last depth check"), std::string::npos);
  RunRecord record = example_run();
  record.steps[1].check->verdict = DepthVerdict::Reject;
  record.steps[1].check->reason = "tip 1.3 mm short of the target";
  EXPECT_NE(report_html(record).find("Last depth check: reject. tip 1.3 mm short of the target"),
            std::string::npos);
}

TEST(ReportHtml, MarksASimulatedRunInTitleBannerPrintAndEveryPictureAndARealRunNowhere) {
  RunRecord record = example_run();
  const std::string html = report_html(record);
  EXPECT_NE(html.find("<title>SIMULATED"), std::string::npos);
  EXPECT_NE(html.find("class=\"watermark\""), std::string::npos);
  const std::size_t drawings = count_of(html, "class=\"needle\"") + count_of(html, "class=\"chart\"");
  EXPECT_EQ(drawings, 8U);  // plan, run; of two steps before, after and their difference
  EXPECT_EQ(count_of(html, "font-weight=\"bold\">SIMULATED</text>"), drawings);
  record.simulated = false;
  EXPECT_EQ(report_html(record).find("SIMULATED"), std::string::npos);
}

TEST(ReportHtml, GivesEveryPictureATextForThoseWhoCannotSeeIt) {
  for (const RunRecord& record : every_kind()) {
    const std::string html = report_html(record);
    EXPECT_EQ(count_of(html, "<img "), count_of(html, " alt=\""));
    EXPECT_EQ(count_of(html, "role=\"img\""), count_of(html, "</title>") - 1);  // one title is the page's
  }
}

TEST(ReportHtml, NeverShowsNanOrInfinity) {
  RunRecord record = example_stop();
  record.limits[0].limit = 0;
  for (StepResult& stage : record.steps) stage.depth_mm = kUnknown;
  const std::string html = report_html(record);
  for (const char* token : {">nan", " nan", "\"nan", ">inf ", " inf", "\"inf", "-nan", "-inf"})
    EXPECT_EQ(html.find(token), std::string::npos) << token;
}

TEST(ReportHtml, IsTheSameForTheSameRecordWhateverTheWallTime) {
  RunRecord other = example_run();
  other.wall_s = 99.0;
  EXPECT_EQ(report_html(example_run()), report_html(other));
}

}  // namespace
}  // namespace biopsy::report
