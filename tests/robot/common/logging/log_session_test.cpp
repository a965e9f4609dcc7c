// Outputs in order, and outputs that block or fail: no call of a logger waits for one.
#include "robot/common/logging/log_session.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>
#include <vector>

#include "robot/common/config_error.hpp"
#include "robot/common/logging/logger.hpp"
#include "robot/common/logging/program.hpp"
#include "tests/full_disk.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::logging {
namespace {

constexpr Logger kDds{Component::Dds};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

bool any_contains(const std::vector<std::string>& lines, const std::string& part) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

// Stands for a terminal or a pipe whose reader does not read until asked to.
class Pipe {
 public:
  Pipe() {
    EXPECT_EQ(::pipe(ends_), 0);
    ::fcntl(ends_[0], F_SETFL, O_NONBLOCK);
  }
  ~Pipe() {
    ::close(ends_[0]);
    ::close(ends_[1]);
  }
  int writing_end() const { return ends_[1]; }
  void fill() const {
    ::fcntl(ends_[1], F_SETFL, O_NONBLOCK);
    const std::string page(4096, '.');
    while (::write(ends_[1], page.data(), page.size()) > 0) {
    }
    ::fcntl(ends_[1], F_SETFL, 0);
  }
  std::string read() const {
    std::string text(1 << 20, '\0');
    const ssize_t size = ::read(ends_[0], text.data(), text.size());
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    return text;
  }

 private:
  int ends_[2]{};
};

int unread(int descriptor) {
  int bytes = 0;
  ::ioctl(descriptor, FIONREAD, &bytes);
  return bytes;
}

class LogFile : public testing::Test {
 protected:
  LogSettings settings(int stream) const {
    LogSettings settings;
    settings.program = "biopsy-test";
    settings.file = file_;
    settings.stream = stream;
    settings.patience = std::chrono::minutes(2);  // however slow the machine is
    return settings;
  }
  std::vector<std::string> lines() const { return lines_of(file_content(file_)); }

  ScratchFolder folder_;
  std::filesystem::path file_ = folder_ / "test.log";
  Pipe stream_;
};

TEST_F(LogFile, TakesInformationAndTheTerminalTakesWarnings) {
  {
    const LogSession session(settings(stream_.writing_end()));
    kDds.debug("not {}", "this");
    kDds.info("participant {} of {}", 1, 2);
    kDds.warning("line one\nline two \x1b[31m");
  }
  const std::string time = R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z )";
  ASSERT_EQ(lines().size(), 2U);
  EXPECT_TRUE(std::regex_match(lines()[0], std::regex(time + "info    dds        participant 1 of 2")))
      << lines()[0];
  const std::string warning = time + R"(warning dds        line one line two  \[31m)";
  EXPECT_TRUE(std::regex_match(lines()[1], std::regex(warning))) << lines()[1];
  const std::vector<std::string> shown = lines_of(stream_.read());
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_EQ(shown[0], lines()[1]);
  struct stat status {};
  ASSERT_EQ(::stat(file_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U) << "messages may name patients";
}

TEST_F(LogFile, TakesTheLevelThatIsAskedFor) {
  for (const auto& [level, count] : {std::pair{Level::Trace, 4U},
                                     {Level::Debug, 4U},
                                     {Level::Info, 3U},
                                     {Level::Warning, 2U},
                                     {Level::Error, 1U},
                                     {Level::Off, 0U}}) {
    std::filesystem::remove(file_);
    LogSettings asked = settings(stream_.writing_end());
    asked.level = level;
    {
      const LogSession session(asked);
      kDds.debug("d"), kDds.info("i"), kDds.warning("w"), kDds.error("e");
    }
    EXPECT_EQ(lines().size(), count);
    EXPECT_EQ(lines_of(stream_.read()).size(), count) << "of file and terminal alike";
  }
}

TEST_F(LogFile, HoldsOneJsonObjectALineWhereAsked) {
  LogSettings json = settings(stream_.writing_end());
  json.format = Format::Json;
  {
    const LogSession session(json);
    kDds.warning("\"quoted\"\nÄ \xff");
  }
  for (const std::string& line : {lines().at(0), lines_of(stream_.read()).at(0)}) {
    const auto object = nlohmann::json::parse(line);
    EXPECT_EQ(object.at("level"), "warning");
    EXPECT_EQ(object.at("component"), "dds");
    EXPECT_EQ(object.at("program"), "biopsy-test");
    EXPECT_EQ(object.at("pid"), ::getpid());
    EXPECT_EQ(object.at("message"), "\"quoted\" Ä \xEF\xBF\xBD");
    EXPECT_EQ(object.at("time").get<std::string>().size(), 24U);
  }
}

TEST_F(LogFile, CanBeNamedOnceTheRunFolderIsThere) {
  LogSettings later = settings(stream_.writing_end());
  later.file.clear();
  {
    LogSession session(later);
    kDds.info("before");
    session.flush();
    log_to_file(file_);
    kDds.info("after");
  }
  ASSERT_EQ(lines().size(), 1U);
  EXPECT_TRUE(lines()[0].ends_with("after"));
}

TEST_F(LogFile, IsRotatedAtFiveMegabytesAndTwoOlderAreKept) {
  {
    LogSession session(settings(stream_.writing_end()));
    for (int n = 0; n < 2'200; ++n) {
      kDds.info("{}", std::string(10'000, 'x'));
      if (n % 1'000 == 0) session.flush();
    }
  }
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    EXPECT_LE(entry.file_size(), 5'000'000U) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 3U);
}

TEST_F(LogFile, ThatCannotBeOpenedIsAWarningAndNoFolderIsMade) {
  LogSettings nowhere = settings(stream_.writing_end());
  nowhere.file = folder_ / "none" / "test.log";
  {
    const LogSession session(nowhere);
    kDds.info("lost");
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
  EXPECT_TRUE(any_contains(lines_of(stream_.read()), "no folder for the log"));
}

// In journald the priority stands before the line and the journal has the time.
TEST_F(LogFile, GivesJournaldItsPriorities) {
  struct stat status {};
  ASSERT_EQ(::fstat(stream_.writing_end(), &status), 0);
  ::setenv("JOURNAL_STREAM", fmt::format("{}:{}", status.st_dev, status.st_ino).c_str(), 1);
  {
    const LogSession session(settings(stream_.writing_end()));
    kDds.warning("late");
    kDds.error("gone");
  }
  ::unsetenv("JOURNAL_STREAM");
  EXPECT_EQ(stream_.read(), "<4>warning dds        late\n<3>error   dds        gone\n");
}

// All calls return although nothing is read, and the file has every message all the same.
TEST_F(LogFile, IsCompleteWhileTheTerminalIsBlocked) {
  stream_.fill();
  LogSession session(settings(stream_.writing_end()));
  for (int n = 0; n < 2'000; ++n) kDds.warning("number {}", n);
  ASSERT_TRUE(session.flush());
  EXPECT_EQ(lines().size(), 2'000U);
  EXPECT_EQ(stream_.read().find("number"), std::string::npos);
  kDds.warning("read again");
  ASSERT_TRUE(session.flush());
  const std::vector<std::string> shown = lines_of(stream_.read());
  EXPECT_TRUE(any_contains(shown, "2000 messages were not shown")) << shown.size();
  EXPECT_TRUE(any_contains(shown, "read again"));
}

// A disk that hangs is a FIFO that nobody reads: the background thread waits in write(), the callers do not.
// What the queue cannot hold is dropped, oldest first, and counted.
TEST_F(LogFile, ThatHangsBlocksNoCallerAndTheDroppedAreCounted) {
  constexpr int kMessages = 20'000;
  ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
  const int reader = ::open(file_.c_str(), O_RDONLY | O_NONBLOCK);
  LogSettings hanging = settings(stream_.writing_end());
  hanging.queue_length = 100;
  hanging.patience = std::chrono::milliseconds(0);
  std::string text;
  {
    LogSession session(hanging);
    while (unread(reader) < 60'000) kDds.info("filler {}", std::string(3'900, '.'));
    for (int n = 0; n < kMessages; ++n) kDds.info("number {}", n);
    EXPECT_FALSE(session.flush()) << "the thread still waits: every call returned without it";
    kDds.info("the end");
    std::string part(1 << 16, '\0');
    while (!text.ends_with("the end\n")) {
      const ssize_t size = ::read(reader, part.data(), part.size());
      if (size > 0) text.append(part, 0, static_cast<std::size_t>(size));
      if (size < 0) std::this_thread::yield();
    }
  }
  ::close(reader);
  std::size_t written = 0, dropped = 0;
  const std::regex counted(R"((\d+) messages were dropped)");
  for (const std::string& line : lines_of(text)) {
    std::smatch match;
    written += line.find("number") != std::string::npos ? 1 : 0;
    if (std::regex_search(line, match, counted)) dropped += std::stoul(match[1]);
  }
  EXPECT_GT(dropped, 19'000U);
  EXPECT_GE(written + dropped, std::size_t{kMessages});
  EXPECT_NE(text.find(fmt::format("number {}\n", kMessages - 1)), std::string::npos) << "the newest are kept";
}

TEST_F(LogFile, OnAFullDiskCountsWhatItCouldNotTakeAndGoesOnWhenThereIsSpace) {
  LogSession session(settings(stream_.writing_end()));
  kDds.info("before");
  ASSERT_TRUE(session.flush());
  {
    const FullDisk full(std::filesystem::file_size(file_));
    for (int n = 0; n < 50; ++n) kDds.info("number {}", n);
    ASSERT_TRUE(session.flush());
  }
  EXPECT_EQ(lines().size(), 1U);
  write(Component::Dds, Level::Info, "after", std::chrono::system_clock::now() + std::chrono::seconds(2));
  ASSERT_TRUE(session.flush());
  ASSERT_EQ(lines().size(), 3U);
  EXPECT_TRUE(any_contains(lines(), "50 messages could not be written to this file"));
  EXPECT_TRUE(any_contains(lines(), "after"));
  EXPECT_TRUE(any_contains(lines_of(stream_.read()), "File too large")) << "said once on the terminal";
}

TEST(LogSettings, AreReadFromTheEnvironment) {
  ::setenv(kLevelVariable, "debug", 1);
  ::setenv(kFormatVariable, "json", 1);
  const LogSettings settings = settings_from_environment("biopsy");
  EXPECT_EQ(settings.level, Level::Debug);
  EXPECT_EQ(settings.format, Format::Json);
  ::setenv(kLevelVariable, "loud", 1);
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_program("biopsy", [] { return settings_from_environment("biopsy").program.empty() ? 1 : 0; }),
            2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "error: \"loud\" is not one of trace, debug, info, warning, error, off\n"
            "where: $BIOPSY_LOG_LEVEL\n"
            "to do: choose from trace, debug, info, warning, error, off\n");
  ::unsetenv(kLevelVariable);
  ::unsetenv(kFormatVariable);
}

TEST(Logger, PrintsWarningsWithoutASession) {
  testing::internal::CaptureStderr();
  kDds.info("nothing");
  kDds.warning("on {}", "stderr");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "warning: dds: on stderr\n");
}

TEST(RunProgram, PrintsThreeLinesAndReturnsTwoForAnyException) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_program("biopsy-test", []() -> int { throw std::runtime_error("broken"); }), 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "error: broken\nwhere: biopsy-test\nto do: report this with what led to it\n");
  EXPECT_EQ(run_program("biopsy-test", [] { return 3; }), 3);
}

}  // namespace
}  // namespace biopsy::logging
