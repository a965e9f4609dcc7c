#include "robot/common/files/csv_table.hpp"

#include <gtest/gtest.h>

#include "robot/common/config_error.hpp"

namespace biopsy {
namespace {

constexpr double kAny = 1e9;

TEST(CsvTable, SkipsBlanksCommentsEmptyLinesAndAByteOrderMark) {
  const CsvTable table =
      CsvTable::parse("\xEF\xBB\xBF# one\r\n\r\nname , x_mm\r\n a,\t1\r\n#two\nb b,-2.5e1", "t.csv");
  EXPECT_EQ(table.rows(), 2U);
  EXPECT_EQ(table.text("name", 1), "b b");
  EXPECT_EQ(table.numbers("x_mm", -kAny, kAny), (std::vector<double>{1, -25}));
  EXPECT_EQ(table.header_place(), "t.csv:3");
  EXPECT_EQ(table.place(1), "t.csv:6");
  EXPECT_FALSE(table.has("y_mm"));
}

TEST(CsvTable, NamesFileLineAndColumnOfWhatItRefuses) {
  const struct {
    const char *text, *place, *what;
  } kCases[] = {{"", "t.csv", "no rows"},
                {"a,b\n", "t.csv", "no rows"},
                {"a,\n1,2\n", "t.csv:1", "\"\" is empty or there twice"},
                {"a,b,a\n1,2,3\n", "t.csv:1", "\"a\" is empty or there twice"},
                {"a,b\n1,2\n1\n", "t.csv:3", "1 cells, but the header names 2"},
                {"a,b\n1,2,3\n", "t.csv:2", "3 cells"},
                {"a\n1\nnan\n", "t.csv:3", "column `a`: \"nan\" is not a finite number"},
                {"a\n1e400\n", "t.csv:2", "not a finite number"},
                {"a\n1 2\n", "t.csv:2", "not a finite number"},
                {"a\n-11\n", "t.csv:2", "column `a`: -11 is outside [-10, 10]"}};
  for (const auto& [text, place, what] : kCases) {
    try {
      CsvTable::parse(text, "t.csv").numbers("a", -10, 10);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.where, place) << text;
      EXPECT_NE(error.what_is_wrong.find(what), std::string::npos) << error.what_is_wrong;
      EXPECT_FALSE(error.remedy.empty());
    }
  }
}

}  // namespace
}  // namespace biopsy
