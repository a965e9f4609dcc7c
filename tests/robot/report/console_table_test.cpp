#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/report/procedure/report.hpp"
#include "tests/robot/report/example_run.hpp"

namespace biopsy::report {
namespace {

std::string last_line(const std::string& text) {
  std::string last;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) last = line;
  return last;
}

TEST(ConsoleTable, NamesPatientTargetLayersStepsMarginsAndEndsWithTheVerdict) {
  const std::string text = console_table(example_run(), false);
  for (const char* part : {"SIMULATED", "DOE, JANE", "TCGA-0001", "t2_tse_sag", "3.50 mm deep",
                           "gap 2.00 to 2.90", "waypoint", "3.49 ± 0.06 accept", "Drive voltage", "1.23"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
  EXPECT_EQ(last_line(text),
            "Completed: needle tip at 3.51 mm in liver; image says 3.49 ± 0.06 mm; target 3.50 mm.");
}

TEST(ConsoleTable, HasNoEscapeCodesUnlessColourIsAskedFor) {
  EXPECT_EQ(console_table(example_stop(), false).find('\033'), std::string::npos);
  EXPECT_NE(console_table(example_stop(), true).find("\033[1;31m"), std::string::npos);
}

TEST(ConsoleTable, APatientNameCannotMoveTheCursorOrAddALine) {
  RunRecord record = example_run();
  const std::string calm = console_table(record, false);
  record.series.patient_name =
      "A\033[2J\r\nB\xC2\x9B"
      "C\xE2\x80\xAE"
      "D";
  const std::string text = console_table(record, false);
  EXPECT_EQ(text.find('\033'), std::string::npos);
  EXPECT_EQ(text.find("\xC2\x9B"), std::string::npos);
  EXPECT_EQ(text.find("\xE2\x80\xAE"), std::string::npos);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), std::count(calm.begin(), calm.end(), '\n'));
}

TEST(ConsoleTable, RefusalEndsWithTheReasonAndTheRemedy) {
  EXPECT_NE(last_line(console_table(example_refusal(), false)).find("What to do: Move the robot"),
            std::string::npos);
}

TEST(ConsoleTable, APlanThatWasNeverRunDoesNotClaimToBeCompleted) {
  RunRecord record;
  record.outcome = Outcome::Completed;
  record.plan = example_run().plan;
  EXPECT_EQ(last_line(console_table(record, false)),
            "Planned, not run: target 3.50 mm in liver, 2 steps. Nothing moved.");
}

TEST(OutsideText, KeepsLettersOfEveryAlphabet) {
  EXPECT_EQ(plain("Jürgen 山田 Ωλ"), "Jürgen 山田 Ωλ");
  EXPECT_EQ(person_name("M\xC3\xBCller^J\xC3\xB6rg^^Dr."), "Müller, Jörg  Dr.");
  EXPECT_EQ(person_name("DOE^"), "DOE");
}

TEST(ReportFolder, HoldsEveryFileWholeAndTheSameBytesForTheSameRecord) {
  const auto root = std::filesystem::path(testing::TempDir()) / "biopsy_report_folder";
  std::filesystem::remove_all(root);
  save_report(example_run(), root / "one");
  save_report(example_run(), root / "two" / "deeper");
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(root / "one")) {
    ++files;
    const auto name = entry.path().filename();
    EXPECT_EQ(read_file(entry.path()), read_file(root / "two" / "deeper" / name)) << name;
    EXPECT_EQ(name.string().find(".part"), std::string::npos);
    EXPECT_GT(std::filesystem::file_size(entry.path()), 100U) << name;
  }
  EXPECT_EQ(files, 10U);  // html, json, csv, planning; of two steps before, after and their difference
  std::filesystem::remove_all(root);
}

TEST(ReportFolder, ThatCannotBeMadeIsRefusedNamingTheFile) {
  const auto in_the_way = std::filesystem::path(testing::TempDir()) / "biopsy_report_in_the_way";
  std::ofstream(in_the_way) << "a file, not a folder";
  try {
    save_report(example_refusal(), in_the_way);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const ConfigError& error) {
    EXPECT_NE(error.where.find("biopsy_report_in_the_way"), std::string::npos);
  }
  std::filesystem::remove(in_the_way);
}

}  // namespace
}  // namespace biopsy::report
