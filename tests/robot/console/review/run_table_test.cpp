// run.csv, read by column name. The texts are written by hand; one whole file comes from the report's writer.
#include "robot/console/review/run_table.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robot/common/config_error.hpp"
#include "robot/report/procedure/report.hpp"
#include "tests/robot/console/review/reads_or_refuses.hpp"
#include "tests/robot/report/example_run.hpp"

namespace biopsy::console {
namespace {

const std::string kHeader =
    "time_s,voltage_V,displacement_mm,current_uA,setpoint_mm,envelope_kV,monitor_kV,mode,stop,stage,gate\n";

const std::vector<double>& column(const RunTable& table, const std::string& name) {
  const auto at = std::find(table.columns.begin(), table.columns.end(), name);
  return table.values.at(static_cast<std::size_t>(at - table.columns.begin()));
}

// The refusal of a table.
ConfigError refusal(const std::string& text) {
  try {
    parse_run_table(text, "run.csv");
  } catch (const ConfigError& refused) {
    return refused;
  }
  return {"nothing was refused", "", ""};
}

TEST(RunTable, ReadsARealRunOfElevenColumns) {
  const RunTable table =
      parse_run_table(kHeader +
                          "0.000,-1500.000,0.50000,-3.5,0.60000,2.0,-1.49,armed,none,1,granted\n"
                          "0.001,1500.000,0.51000,3.5,0.60000,2.0,1.51,active,none,1,limited\n"
                          "0.003,0.000,0.52000,0,0.60000,2.0,0,active,none,2,granted\n",
                      "run.csv");
  EXPECT_EQ(table.columns.size(), 7U);
  EXPECT_EQ(table.columns.front(), "time_s");
  EXPECT_EQ(column(table, "time_s"), (std::vector{0.0, 0.001, 0.003}));
  EXPECT_EQ(column(table, "voltage_V"), (std::vector{-1500.0, 1500.0, 0.0}));
  EXPECT_EQ(column(table, "displacement_mm"), (std::vector{0.5, 0.51, 0.52}));
  ASSERT_EQ(table.spans.size(), 3U);
  EXPECT_EQ(table.spans[0].mode, Mode::Armed);
  EXPECT_EQ(table.spans[1].mode, Mode::Active);
  EXPECT_EQ(table.spans[1].from, 0.001);
  EXPECT_EQ(table.spans[2].step, 2U);
}

TEST(RunTable, FindsColumnsByNameInAnyOrder) {
  const RunTable table = parse_run_table(
      "gate,stage,stop,mode,tip_mm,monitor_kV,envelope_kV,setpoint_mm,current_uA,plate_b_mm,displacement_mm,"
      "voltage_V,time_s\n"
      "granted,3,C1 ramp,trip,0.1,0.2,0.3,0.4,0.5,0.6,0.7,0.8,0.9\n",
      "run.csv");
  EXPECT_EQ(table.columns.size(), 9U);
  EXPECT_EQ(column(table, "tip_mm").front(), 0.1);
  EXPECT_EQ(column(table, "plate_b_mm").front(), 0.6);
  EXPECT_EQ(column(table, "time_s").front(), 0.9);
  EXPECT_EQ(table.spans.front().stop, StopCategory::C1Ramp);
}

TEST(RunTable, OfTheReportsWriterHasEverySampleAndEveryChangeOfState) {
  report::RunRecord record = report::example_run();
  for (const bool simulated : {true, false}) {
    record.simulated = simulated;
    const RunTable table = parse_run_table(report::run_csv(record), "run.csv");
    EXPECT_EQ(table.columns.size(), simulated ? 10U : 8U);
    for (std::size_t k = 0; k < record.samples.size(); ++k)
      ASSERT_EQ(column(table, "locked")[k] > 0.0, record.samples[k].locked);
    ASSERT_EQ(column(table, "time_s").size(), record.samples.size());
    std::size_t changes = 1;
    for (std::size_t k = 1; k < record.samples.size(); ++k) {
      const report::Sample &now = record.samples[k], &before = record.samples[k - 1];
      changes += now.mode != before.mode || now.stop != before.stop || now.step != before.step;
      ASSERT_NEAR(column(table, "displacement_mm")[k], now.depth_mm, 1e-5);
    }
    EXPECT_EQ(table.spans.size(), changes);
  }
}

TEST(RunTable, SaysWhatIsWrongAndWhere) {
  const std::string row = "0.000,0,0,0,0,0,0,safe,none,1,granted\n";
  const struct {
    std::string text, what, where;
  } kWrong[] = {
      {"", "no rows", "run.csv"},
      {kHeader, "no rows", "run.csv"},
      {"time_s,mode\n0,safe\n", "`displacement_mm` is missing", "run.csv:1"},
      {"extra," + kHeader + "1," + row, "`extra` is not known", "run.csv:1"},
      {kHeader + row + "0.001,0,nan,0,0,0,0,safe,none,1,granted\n", "displacement_mm", "run.csv:3"},
      {kHeader + row + "0.001,0,1e9,0,0,0,0,safe,none,1,granted\n", "displacement_mm", "run.csv:3"},
      {kHeader + "-0.001,0,0,0,0,0,0,safe,none,1,granted\n", "time_s", "run.csv:2"},
      {kHeader + row + "0.002,0,0,0,0,0,0,safe,none,1,granted\n" + "0.001,0,0,0,0,0,0,safe,none,1,granted\n",
       "time runs back", "run.csv:4"},
      {kHeader + "0,0,0,0,0,0,0,asleep,none,1,granted\n", "asleep", "run.csv:2"},
      {kHeader + "0,0,0,0,0,0,0,safe,sudden,1,granted\n", "sudden", "run.csv:2"},
      {kHeader + "0,0,0,0,0,0,0,safe,none,1,open\n", "open", "run.csv:2"},
      {kHeader + "0,0,0,0,0,0,0,safe,none,0,granted\n", "stage", "run.csv:2"},
      {kHeader + "0,0,0,0,0,0,0,safe,none,1\n", "10 cells", "run.csv:2"},
  };
  for (const auto& wrong : kWrong) {
    const ConfigError refused = refusal(wrong.text);
    EXPECT_NE(refused.what_is_wrong.find(wrong.what), std::string::npos) << refused.what_is_wrong;
    EXPECT_EQ(refused.where, wrong.where) << refused.what_is_wrong;
    EXPECT_FALSE(refused.remedy.empty());
  }
}

TEST(RunTable, WithOneWrongByteOrCutOffIsReadOrRefused) {
  every_spoilt_text_is_read_or_refused(kHeader +
                                           "0.000,-1500.5,0.5,-3.5,0.6,2.0,-1.49,armed,C2 hold,1,granted\n" +
                                           "0.001,1500,0.51,3.5,0.6,2.0,1.51,active,none,1,second writer\n",
                                       [](const std::string& text) { parse_run_table(text, "run.csv"); });
}

}  // namespace
}  // namespace biopsy::console
