// biopsy log: exit codes, output and CSV.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>

#include <array>
#include <cstdlib>

#include "robot/recorder/recorder.hpp"
#include "robot/security/make_keys.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_dir.hpp"

namespace biopsy {
namespace {

class LogCommand : public testing::Test {
 protected:
  void SetUp() override {
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    security::make_keys(folder_ / "keys", 1, now, false);
    recorder::Recorder recorder(log_, SigningKey(folder_ / "keys/recorder/signing_key.pem"));
    for (int n = 0; n < 5; ++n)
      recorder.append({n, n, "test", recorder::RecordKind::OperatorAct, "comma, \"quote\"\nand line"},
                      recorder::Urgency::Grouped, n);
    ASSERT_TRUE(recorder.flush(10));
  }

  int answer(const std::string& words) const {
    const std::string command = fmt::format("{}/biopsy log {} > {} 2>&1", binary_dir().string(), words,
                                            (folder_ / "printed").string());
    return WEXITSTATUS(std::system(command.c_str()));
  }
  void change(const char* sql) const {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(log_.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(database);
  }

  const ScratchFolder folder_;
  const std::filesystem::path log_ = folder_ / "procedure.sqlite";
};

TEST_F(LogCommand, SaysThatAnIntactLogIsIntact) {
  EXPECT_EQ(answer("verify " + log_.string()), 0);
  EXPECT_EQ(answer("show --last 2 " + log_.string()), 0);
  EXPECT_NE(file_content(folder_ / "printed").find("operator act"), std::string::npos);
}

TEST_F(LogCommand, ExportsTextsAsCsvThatReadsBack) {
  EXPECT_EQ(answer("export " + log_.string() + " --csv " + (folder_ / "log.csv").string()), 0);
  const std::string csv = file_content(folder_ / "log.csv");
  EXPECT_NE(csv.find("\"comma, \"\"quote\"\"\nand line\""), std::string::npos) << csv;
}

TEST_F(LogCommand, EndsWithOneAndNamesTheRecordThatWasChanged) {
  change("UPDATE record SET body = 'nothing happened' WHERE seq = 3");
  EXPECT_EQ(answer("verify " + log_.string()), 1);
  EXPECT_NE(file_content(folder_ / "printed").find("3"), std::string::npos);
  EXPECT_EQ(answer("show " + log_.string()), 1);
}

TEST_F(LogCommand, EndsWithOneWhereTheEndWasCutOff) {
  change("DELETE FROM record WHERE seq = 5");
  EXPECT_EQ(answer("verify " + log_.string()), 1);
}

// A slip of the pen must not look like a log in which nothing happened.
TEST_F(LogCommand, RefusesATimeOrASourceThatThereIsNot) {
  for (const char* words :
       {"--source tset", "--since '2026-13-01'", "--since '2026-04-31 10:00'", "--until '2026-04-30 24:00'",
        "--until '2026-04-30 10:60:00'", "--since '2027-01-01' --until '2026'",
        "--since '2026-05-02 10:00' --until '2026-05-02 09'"}) {
    EXPECT_EQ(answer(fmt::format("show {} {}", log_.string(), words)), 2) << words;
    EXPECT_NE(file_content(folder_ / "printed").find("error"), std::string::npos);
  }
  for (const char* words : {"--source test", "--since '1970-01-01 00:00'", "--until '2028-02-29T23:59:60'",
                            "--since '1970-01-01 00:00:00' --until '1970-01-01'"}) {
    EXPECT_EQ(answer(fmt::format("show {} {}", log_.string(), words)), 0) << words;
    EXPECT_NE(file_content(folder_ / "printed").find("operator act"), std::string::npos) << words;
  }
}

TEST_F(LogCommand, EndsWithTwoWhereThereIsNoLog) {
  EXPECT_EQ(answer("verify " + (folder_ / "nothing").string()), 2);
}

}  // namespace
}  // namespace biopsy
