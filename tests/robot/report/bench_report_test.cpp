#include "robot/report/study/bench_report.hpp"

#include <gtest/gtest.h>

#include "tests/count_of.hpp"

namespace biopsy::report {
namespace {

BenchRecord two_runs() {
  BenchRecord record;
  record.title = "InsertionStep <A>";
  record.device = "simulated stage";
  record.planned_runs = 3;
  record.sensor_noise_mm = 0.0102;
  BenchRunRecord run;
  run.name = "load-50g";
  run.what = "a push & a pull";
  run.weight_g = 50;
  run.expected_mm = 5.2;
  for (int i = 0; i < 1000; ++i) {
    run.time_s.push_back(i * 1e-3);
    run.drive_kV.push_back(i % 500 < 250 ? 2.4 : -2.4);
    run.displacement_mm.push_back(4.73);
    run.push_N.push_back(i > 600 ? 0.065 : 0.0);
  }
  record.runs.push_back(run);
  run.name = "impact-50g";
  run.push_N.assign(1000, 0.0);
  run.stopped_because = "trip: R-15 needle fell back: drive lost";
  run.stopped_s = 0.731;
  record.runs.push_back(run);
  return record;
}

TEST(BenchReport, ShowsAPictureOfEveryRunAndThePushOnlyWhereThereWasOne) {
  const std::string html = bench_html(two_runs());
  EXPECT_EQ(count_of(html, "<figure>"), 2U);
  EXPECT_EQ(count_of(html, "Push (N)"), 1U);
  EXPECT_EQ(count_of(html, "Displacement (mm)"), 2U);
}

TEST(BenchReport, SaysWhichRunWasStoppedWhenAndWhy) {
  const std::string html = bench_html(two_runs()), text = bench_console(two_runs());
  for (const std::string& page : {html, text})
    EXPECT_NE(page.find("stopped at 0.73 s, trip: R-15 needle fell back"), std::string::npos) << page;
  EXPECT_NE(text.find("1 of 3 runs were not begun"), std::string::npos) << text;
  EXPECT_NE(html.find("2 of 3"), std::string::npos);
}

TEST(BenchReport, TakesNothingFromOutsideAsMarkup) {
  const std::string html = bench_html(two_runs());
  EXPECT_EQ(html.find("<A>"), std::string::npos);
  EXPECT_NE(html.find("InsertionStep &lt;A&gt;"), std::string::npos);
  EXPECT_NE(html.find("a push &amp; a pull"), std::string::npos);
}

TEST(BenchReport, SaysThatNothingRealMovedOnlyWhereThatIsSo) {
  BenchRecord record = two_runs();
  EXPECT_NE(bench_html(record).find("SIMULATED"), std::string::npos);
  record.simulated = false;
  EXPECT_EQ(bench_html(record).find("SIMULATED"), std::string::npos);
}

TEST(BenchReport, SurvivesARunThatWasStoppedBeforeItBegan) {
  BenchRecord record = two_runs();
  BenchRunRecord& run = record.runs.back();
  run.time_s = run.drive_kV = run.displacement_mm = run.push_N = {};
  EXPECT_EQ(count_of(bench_html(record), "<figure>"), 1U);
  EXPECT_NE(bench_console(record).find("impact-50g"), std::string::npos);
}

}  // namespace
}  // namespace biopsy::report
