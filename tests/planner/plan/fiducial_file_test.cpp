#include "planner/plan/fiducial_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "robot/common/config_error.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::planner {
namespace {

const std::string kHeader = "name,robot_x_mm,robot_y_mm,robot_z_mm,scanner_r_mm,scanner_a_mm,scanner_s_mm\n";
const std::string kGood = kHeader + "F1,0,0,0,10,20,30\nF2,50,0,0,60,20,30\nF3,0,50,0,10,70,30\n";

std::vector<FiducialPair> read(const std::string& text) {
  return parse_fiducials(text, "frame.csv");
}

// The error a text must cause; every error names the file and a remedy.
ConfigError error_of(const std::string& text) {
  try {
    read(text);
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.where.rfind("frame.csv", 0), 0u) << error.where;
    EXPECT_FALSE(error.remedy.empty());
    return error;
  }
  ADD_FAILURE() << "accepted: " << text;
  return {"", "", ""};
}

TEST(FiducialFile, TurnsRasIntoLps) {
  verifies("R-61");
  const auto pairs = read(kGood);
  ASSERT_EQ(pairs.size(), 3u);
  EXPECT_EQ(pairs[1].name, "F2");
  EXPECT_EQ(pairs[1].p_RF, Point(50, 0, 0));
  EXPECT_EQ(pairs[1].p_SF, Point(-60, -20, 30));
}

TEST(FiducialFile, ReadsSpreadsheetHabits) {
  EXPECT_EQ(
      read("\xEF\xBB\xBF# measured on Monday\r\n\r\n" + kHeader + " F1 , 0 ,\t1, 2,3,4,-5e0\r\n").size(), 1u);
}

TEST(FiducialFile, NamesLineAndColumnOfWhatIsNotANumber) {
  for (const std::string bad : {"nan", "inf", "-inf", "", "12,5", "1e999", "0x10", "12mm", "--3", "1 2"}) {
    const ConfigError error = error_of(kHeader + "F1,0,0,0,10,20,30\nF2,50,0," + bad + ",60,20,30\n");
    EXPECT_EQ(error.where, "frame.csv:3") << bad;
    EXPECT_NE(error.what_is_wrong.find(bad == "12,5" ? "8 cells" : "column `robot_z_mm`"), std::string::npos)
        << bad << ": " << error.what_is_wrong;
  }
}

TEST(FiducialFile, RefusesOtherUnitsByName) {
  for (const std::string unit : {"_cm", "_m", "", "_inch"}) {
    std::string text = kGood;
    text.replace(text.find("scanner_a_mm"), 12, "scanner_a" + unit);
    const ConfigError error = error_of(text);
    EXPECT_NE(error.what_is_wrong.find("not in millimetres"), std::string::npos) << error.what_is_wrong;
    EXPECT_EQ(error.where, "frame.csv:1");
    EXPECT_NE(error.remedy.find("scanner_a_mm"), std::string::npos);
  }
}

TEST(FiducialFile, RefusesEachMissingColumn) {
  for (const std::string column :
       {"name,", "robot_x_mm,", "robot_y_mm,", "robot_z_mm,", "scanner_r_mm,", "scanner_a_mm,"}) {
    std::string header = kHeader;
    header.erase(header.find(column), column.size());
    const ConfigError error = error_of(header + "F1,0,0,0,1,2\n");
    EXPECT_NE(error.what_is_wrong.find(column.substr(0, column.size() - 1) + "` is missing"),
              std::string::npos)
        << error.what_is_wrong;
  }
}

TEST(FiducialFile, RefusesLpsColumns) {
  std::string text = kGood;
  text.replace(text.find("scanner_r_mm"), 12, "scanner_l_mm");
  EXPECT_NE(error_of(text).what_is_wrong.find("unknown column `scanner_l_mm`"), std::string::npos);
}

TEST(FiducialFile, RefusesWhatIsThereTwice) {
  EXPECT_NE(error_of(kGood + "F2,1,2,3,4,5,6\n").what_is_wrong.find("'F2' is there twice"),
            std::string::npos);
  EXPECT_NE(error_of(kGood + "F4,50,0,0,4,5,6\n").what_is_wrong.find("position of 'F2'"), std::string::npos);
  EXPECT_NE(error_of(kGood + "F4,1,2,3,60,20,30\n").what_is_wrong.find("position of 'F2'"),
            std::string::npos);
  EXPECT_NE(error_of("name,name,robot_x_mm\n").what_is_wrong.find("twice"), std::string::npos);
}

TEST(FiducialFile, RefusesNumbersThatCannotBeMillimetresInAScanner) {
  EXPECT_NE(error_of(kHeader + "F1,0,0,0,10,20,30000\n").remedy.find("unit"), std::string::npos);
}

TEST(FiducialFile, RefusesEmptyShortAndNamelessLines) {
  error_of("");
  error_of("# only a comment\n");
  EXPECT_NE(error_of(kHeader + "F1,0,0\n").what_is_wrong.find("3 cells"), std::string::npos);
  EXPECT_NE(error_of(kHeader + ",0,0,0,1,2,3\n").what_is_wrong.find("no name"), std::string::npos);
  EXPECT_THROW(read_fiducials(std::filesystem::path("no/such/file.csv")), ConfigError);
}

TEST(FiducialFile, ReturnsWhatWasWrittenInAnyOrderOfColumns) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> anywhere(-999.0, 999.0);
  const std::vector<std::string> names = {"name",         "robot_x_mm",   "robot_y_mm",  "robot_z_mm",
                                          "scanner_r_mm", "scanner_a_mm", "scanner_s_mm"};
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<std::size_t> order = {0, 1, 2, 3, 4, 5, 6};
    std::shuffle(order.begin(), order.end(), random);
    std::string text;
    for (const std::size_t column : order) text += (text.empty() ? "" : ",") + names[column];
    std::vector<std::array<double, 6>> written(5);
    for (std::size_t row = 0; row < written.size(); ++row) {
      for (double& number : written[row]) number = anywhere(random);
      std::string line;
      for (const std::size_t column : order)
        line += (line.empty() ? "" : ",") +
                (column == 0 ? fmt::format("F{}", row) : fmt::format("{}", written[row][column - 1]));
      text += "\n" + line;
    }
    const auto pairs = read(text);
    ASSERT_EQ(pairs.size(), written.size());
    for (std::size_t row = 0; row < pairs.size(); ++row) {
      EXPECT_EQ(pairs[row].p_RF, Point(written[row][0], written[row][1], written[row][2]));
      EXPECT_EQ(ras_from_lps(pairs[row].p_SF), Point(written[row][3], written[row][4], written[row][5]));
    }
  }
}

// Whatever the bytes, the reader either throws ConfigError or returns pairs that are sound.
TEST(FiducialFile, SurvivesDamagedFiles) {
  std::mt19937_64 random(11);
  int refused = 0, accepted = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::string text = kGood;
    const int damages = 1 + static_cast<int>(random() % 2);
    for (int n = 0; n < damages && !text.empty(); ++n) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(at, 1 + random() % 9);
          break;
        case 2:
          text.insert(at, 1, ",\n\"-.e#\0"[random() % 8]);
          break;
        default:
          text.resize(at);
          break;
      }
    }
    try {
      std::set<std::string> names;
      for (const FiducialPair& pair : read(text)) {
        EXPECT_TRUE(pair.p_RF.allFinite() && pair.p_SF.allFinite());
        EXPECT_LE(pair.p_RF.cwiseAbs().maxCoeff(), 1000.0);
        EXPECT_FALSE(pair.name.empty());
        EXPECT_TRUE(names.insert(pair.name).second);
      }
      ++accepted;
    } catch (const ConfigError& error) {
      EXPECT_FALSE(error.where.empty() || error.remedy.empty());
      ++refused;
    }
  }
  EXPECT_GT(refused, 5000);  // the damage bites,
  EXPECT_GT(accepted, 500);  // and is not always fatal: a changed digit cannot be seen
}

}  // namespace
}  // namespace biopsy::planner
