#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "robot/report/procedure/report.hpp"
#include "tests/robot/report/example_run.hpp"

namespace biopsy::report {
namespace {

using nlohmann::json;

enum class Kind { Text, Number, List };
struct Field {
  const char* name;
  Kind kind;
  bool may_be_null;
};

// The interface, field by field.
constexpr Field kInterface[] = {
    {"outcome", Kind::Text, false},
    {"refusal", Kind::Text, true},
    {"target_depth_mm", Kind::Number, true},
    {"final_depth_mm", Kind::Number, true},
    {"left_depth_mm", Kind::Number, true},
    {"image_depth_mm", Kind::Number, true},
    {"image_depth_sigma_mm", Kind::Number, true},
    {"layer_at_tip", Kind::Text, true},
    {"rmse_settled_mm", Kind::Number, true},
    {"rmse_all_mm", Kind::Number, true},
    {"overshoot_mm", Kind::Number, true},
    {"peak_kV", Kind::Number, true},
    {"trips", Kind::List, false},
    {"stages", Kind::List, false},
    {"simulated_s", Kind::Number, true},
    {"wall_s", Kind::Number, true},
};

void expect_interface(const json& report) {
  for (const Field& field : kInterface) {
    ASSERT_TRUE(report.contains(field.name)) << field.name;
    const json& value = report[field.name];
    if (value.is_null()) {
      EXPECT_TRUE(field.may_be_null) << field.name;
      continue;
    }
    EXPECT_EQ(value.is_string(), field.kind == Kind::Text) << field.name;
    EXPECT_EQ(value.is_number(), field.kind == Kind::Number) << field.name;
    EXPECT_EQ(value.is_array(), field.kind == Kind::List) << field.name;
  }
}

TEST(ReportJson, HoldsEveryInterfaceFieldWhetherCompletedRefusedOrStopped) {
  for (const RunRecord& record : {example_run(), example_refusal(), example_stop(), RunRecord{}})
    expect_interface(json::parse(report_json(record)));
}

TEST(ReportJson, CompletedRunLeavesNoFigureNullAndHasNoRefusal) {
  const json report = json::parse(report_json(example_run()));
  for (const Field& field : kInterface)
    EXPECT_EQ(report[field.name].is_null(), std::string(field.name) == "refusal") << field.name;
  EXPECT_EQ(report["outcome"], "completed");
  EXPECT_DOUBLE_EQ(report["final_depth_mm"], 3.508);
  EXPECT_DOUBLE_EQ(report["peak_kV"], 6.77);
  EXPECT_EQ(report["stages"].size(), 2U);
  EXPECT_EQ(report["stages"][1]["check"]["verdict"], "accept");
  EXPECT_EQ(report["image_depth_verdict"], "accept");
}

TEST(ReportJson, RefusedRunSaysWhyAndClaimsNoDepthEvenIfTheRecordHoldsZeros) {
  RunRecord record = example_refusal();
  record.final_depth_mm = record.rmse_all_mm = record.peak_kV = 0.0;
  const json report = json::parse(report_json(record));
  EXPECT_EQ(report["outcome"], "refused");
  EXPECT_EQ(report["refusal"], record.refusal);
  for (const char* name : {"target_depth_mm", "final_depth_mm", "rmse_all_mm", "peak_kV", "layer_at_tip"})
    EXPECT_TRUE(report[name].is_null()) << name;
}

TEST(ReportJson, InfinityAndNanBecomeNull) {
  RunRecord record = example_run();
  record.final_depth_mm = kUnknown;
  record.overshoot_mm = std::numeric_limits<double>::infinity();
  record.limits[0].limit = 0.0;
  const json report = json::parse(report_json(record));  // the parser refuses NaN and infinity
  EXPECT_TRUE(report["final_depth_mm"].is_null());
  EXPECT_TRUE(report["overshoot_mm"].is_null());
  EXPECT_TRUE(report["limits"][0]["used_percent"].is_null());
}

TEST(ReportJson, PatientNameInABrokenEncodingStillGivesValidJson) {
  RunRecord record = example_run();
  record.series.patient_name = "M\xFCller^J\xF6rg";  // Latin-1
  EXPECT_TRUE(json::accept(report_json(record)));
}

TEST(ReportJson, DiffersBetweenTwoRunsOfOneSeedInWallTimeOnly) {
  RunRecord other = example_run();
  other.wall_s = 12.5;
  json first = json::parse(report_json(example_run())), second = json::parse(report_json(other));
  EXPECT_NE(first, second);
  first.erase("wall_s");
  second.erase("wall_s");
  EXPECT_EQ(first, second);
  EXPECT_EQ(report_json(example_run()), report_json(example_run()));
}

TEST(ReportJson, TripsCarryTimeStopAndReasonInOrder) {
  const json report = json::parse(report_json(example_stop()));
  ASSERT_EQ(report["trips"].size(), 2U);
  EXPECT_DOUBLE_EQ(report["trips"][0]["time_s"], 13.2);
  EXPECT_EQ(report["trips"][1]["stop"], "C0 off");
  EXPECT_TRUE(report["stages"][1]["check"].is_null());
  EXPECT_FALSE(report["stages"][1]["reached"]);
}

}  // namespace
}  // namespace biopsy::report
