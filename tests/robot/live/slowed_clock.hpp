// The present test once more, alone, as a process with a clock at a quarter of its speed, and so all
// processes that it starts: where a machine stands still for 10 ms, their clock does so for 2.5 ms. The
// programs and their messages are the same; what is asserted of time is asserted four times as mildly,
// therefore no test of a deadline is judged so.
#pragma once

#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "robot/common/files/file.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::live_tests {

// Debian's package faketime; the times of files stay the kernel's, which are later.
inline constexpr const char* kSlowedClock[] = {"NO_FAKE_STAT=1", "faketime", "-f", "+0 x0.25"};

inline constexpr std::string_view kJudgedWithSlowedClock = "judged with a clock at a quarter of its speed";

enum class Judged { Passed, Failed, NotJudged };

inline bool is_clock_slowed() {
  return std::getenv("FAKETIME") != nullptr;
}

// Sanitizers bear no library that is loaded before theirs, as faketime's is.
constexpr bool can_slow_the_clock() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return false;
#else
  return true;
#endif
}

// As this process found them: what a test has changed since is of its own run.
inline const std::filesystem::path kCameFrom = std::filesystem::current_path();
inline const std::vector<std::string> kEnvironment = [] {
  std::vector<std::string> all;
  for (char** entry = environ; *entry != nullptr; ++entry) all.emplace_back(*entry);
  return all;
}();

inline std::vector<const char*> pointers(const std::vector<std::string>& words) {
  std::vector<const char*> all;
  for (const std::string& word : words) all.push_back(word.c_str());
  all.push_back(nullptr);
  return all;
}

inline Judged judge_with_slowed_clock() {
  const ::testing::TestInfo* test = ::testing::UnitTest::GetInstance()->current_test_info();
  const ScratchFolder folder;
  const std::filesystem::path result = folder / "result.json";
  std::vector<std::string> words{"env", "--chdir", kCameFrom.string()};
  words.insert(words.end(), std::begin(kSlowedClock), std::end(kSlowedClock));
  words.push_back(std::filesystem::read_symlink("/proc/self/exe").string());
  words.push_back(std::string("--gtest_filter=") + test->test_suite_name() + "." + test->name());
  words.push_back("--gtest_output=json:" + result.string());
  const auto arguments = pointers(words), environment = pointers(kEnvironment);
  pid_t child = -1;
  if (posix_spawnp(&child, arguments[0], nullptr, nullptr, const_cast<char* const*>(arguments.data()),
                   const_cast<char* const*>(environment.data())) != 0)
    return Judged::NotJudged;
  int status = 0;
  waitpid(child, &status, 0);
  const std::string told = read_file_if_present(result);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || told.empty()) return Judged::Failed;
  return told.find("\"SKIPPED\"") == std::string::npos ? Judged::Passed : Judged::NotJudged;
}

}  // namespace biopsy::live_tests
