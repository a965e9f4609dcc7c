// report.json, as far as the review page shows it. Reports come from the report's writer over an example that
// is made up; what is wrong is put in by hand.
#include "robot/console/review/run_report.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "robot/common/config_error.hpp"
#include "robot/report/procedure/report.hpp"
#include "tests/robot/console/review/reads_or_refuses.hpp"
#include "tests/robot/report/example_run.hpp"

namespace biopsy::console {
namespace {

using Json = nlohmann::json;

TEST(RunReport, HasOutcomeImagesAndHazardsAtTheirTimes) {
  report::RunRecord record = report::example_stop();
  record.seed = 77;
  record.steps.at(0).image_s = 9.5;
  record.trips = {{12.25, StopCategory::C1Ramp, "H-15 needle fell back"},
                  {13.0, StopCategory::C0Off, "H-25"}};
  const RunReport read = parse_run_report(report::report_json(record), "report.json");
  EXPECT_EQ(read.outcome, "stopped");
  EXPECT_EQ(read.title, record.title);
  EXPECT_EQ(read.seed, "77");
  ASSERT_EQ(read.hazards.size(), 2U);
  EXPECT_EQ(read.hazards[0].at, 12.25);
  EXPECT_EQ(read.hazards[0].stop, StopCategory::C1Ramp);
  EXPECT_EQ(read.hazards[1].reason, "H-25");
  ASSERT_FALSE(read.images.empty());
  EXPECT_EQ(read.images[0].step, 1U);
  EXPECT_EQ(read.images[0].at, 9.5);
  EXPECT_EQ(read.images[0].planned, record.steps[0].step.depth.value);
  EXPECT_EQ(read.images[0].verdict, "accept");
  EXPECT_NEAR(read.images[0].found, record.steps[0].check->depth.value, 1e-4);
}

TEST(RunReport, OfAStepWithoutImageHasNone) {
  report::RunRecord record = report::example_run();
  for (report::StepResult& step : record.steps) step.image_s = report::kUnknown;
  EXPECT_TRUE(parse_run_report(report::report_json(record), "report.json").images.empty());
}

TEST(RunReport, OfAnotherVersionWithMoreEntriesIsRead) {
  Json more = Json::parse(report::report_json(report::example_run()));
  more["invented_later"] = Json::array({1, 2});
  EXPECT_EQ(parse_run_report(more.dump(), "report.json").outcome, "completed");
}

TEST(RunReport, OfARefusalSaysThatNothingMoved) {
  try {
    parse_run_report(report::report_json(report::example_refusal()), "report.json");
    FAIL() << "a refusal was read";
  } catch (const ConfigError& refused) {
    EXPECT_NE(refused.what_is_wrong.find("nothing moved"), std::string::npos) << refused.what_is_wrong;
  }
}

TEST(RunReport, SaysWhichEntryIsWrong) {
  report::RunRecord record = report::example_stop();
  record.steps.at(0).image_s = 9.5;
  record.trips = {{1.0, StopCategory::C0Off, "H-25"}};
  const Json whole = Json::parse(report::report_json(record));
  const struct {
    const char* names;
    std::function<void(Json&)> spoil;
  } kWrong[] = {
      {"`outcome` is missing", [](Json& one) { one.erase("outcome"); }},
      {"`outcome` is none", [](Json& one) { one["outcome"] = "won"; }},
      {"`title` is not a text", [](Json& one) { one["title"] = 3; }},
      {"`simulated` is neither", [](Json& one) { one["simulated"] = 1; }},
      {"`seed` is not a whole", [](Json& one) { one["seed"] = -1; }},
      {"`trips` is not a list", [](Json& one) { one["trips"] = "none"; }},
      {"`stages` is missing", [](Json& one) { one.erase("stages"); }},
      {"`time_s` is not a number", [](Json& one) { one["trips"][0]["time_s"] = -1.0; }},
      {"`stop` is none", [](Json& one) { one["trips"][0]["stop"] = "C9"; }},
      {"`image_s` is not a number", [](Json& one) { one["stages"][0]["image_s"] = 1e99; }},
      {"`number` is no step", [](Json& one) { one["stages"][0]["number"] = 0; }},
      {"`verdict` is none", [](Json& one) { one["stages"][0]["check"]["verdict"] = "maybe"; }},
      {"`sigma_mm` is not a number", [](Json& one) { one["stages"][0]["check"]["sigma_mm"] = -0.1; }},
      {"is not an object", [](Json& one) { one["stages"][0]["check"] = "accept"; }},
      {"is not an object", [](Json& one) { one = Json::array(); }},
  };
  for (const auto& wrong : kWrong) {
    Json spoilt = whole;
    wrong.spoil(spoilt);
    try {
      parse_run_report(spoilt.dump(), "report.json");
      ADD_FAILURE() << "read although " << wrong.names;
    } catch (const ConfigError& refused) {
      EXPECT_NE(refused.what_is_wrong.find(wrong.names), std::string::npos) << refused.what_is_wrong;
      EXPECT_EQ(refused.where.find("report.json"), 0U);
    }
  }
  EXPECT_THROW(parse_run_report("{", "report.json"), ConfigError);
}

TEST(RunReport, WithOneWrongByteOrCutOffIsReadOrRefused) {
  report::RunRecord record = report::example_stop();
  record.steps.resize(1);
  record.steps[0].image_s = 9.5;
  record.trips = {{1.0, StopCategory::C0Off, "H-25"}};
  Json small = Json::parse(report::report_json(record));
  for (const char* other : {"limits", "provenance", "series", "warnings"}) small.erase(other);
  every_spoilt_text_is_read_or_refused(
      small.dump(), [](const std::string& text) { parse_run_report(text, "report.json"); });
}

}  // namespace
}  // namespace biopsy::console
