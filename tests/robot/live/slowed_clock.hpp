// The present test once more, alone, as a process with a slowed clock, and so all processes that it starts:
// where a machine stands still for 10 ms, a clock at a quarter of its speed does so for 2.5 ms. The programs
// and their messages are the same; every time that is asserted is stretched four times, so that of a deadline
// it shows what the programs do about it, and not that these processors are fast enough.
#pragma once

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "robot/common/files/file.hpp"
#include "tests/robot/live/host_watch.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::live_tests {

enum class Repeated { Passed, Failed, Skipped };

inline bool is_clock_slowed() {
  return std::getenv("FAKETIME") != nullptr;
}

inline bool is_clock_slowest() {
  return is_clock_slowed() && std::getenv("FAKETIME") == fmt::format("+0 x{}", kClockSpeeds.back());
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
  for (char** entry = environ; *entry != nullptr; ++entry)
    if (!std::string_view(*entry).starts_with("GTEST_")) all.emplace_back(*entry);
  return all;
}();

using Moment = std::chrono::steady_clock::time_point;

inline std::vector<pid_t> children() {
  std::vector<pid_t> all;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (!std::ranges::all_of(name, [](unsigned char c) { return std::isdigit(c) != 0; })) continue;
    const std::string stat = read_file_if_present(entry.path() / "stat");  // pid (name) state parent ...
    std::istringstream after_name(stat.substr(std::min(stat.size(), stat.rfind(')') + 1)));
    std::string state;
    pid_t parent = 0;
    if (after_name >> state >> parent && parent == getpid()) all.push_back(std::stoi(name));
  }
  return all;
}

// A robot's processes are not of the group of who started them: those that outlive that one become children
// of this process (PR_SET_CHILD_SUBREAPER), where they would hold the names of the next robot.
inline void end_orphans(const std::vector<pid_t>& own) {
  for (bool any = true; any;) {
    any = false;
    for (const pid_t child : children())
      if (std::ranges::find(own, child) == own.end()) {
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        any = true;
      }
  }
}

// Its status, or nothing where it had to be ended.
inline std::optional<int> status_of(pid_t child, Moment until) {
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (std::chrono::steady_clock::now() < until) continue;
    kill(-child, SIGKILL);
    waitpid(child, &status, 0);
    return std::nullopt;
  }
  return status;
}

// Debian's package faketime; the times of files stay the kernel's, which are later. It does not know of waits
// for a condition on the steady clock: slowed_waits beside the test programs does.
inline Repeated repeat_with_clock_at(double speed, Moment until) {
  const ::testing::TestInfo* test = ::testing::UnitTest::GetInstance()->current_test_info();
  const ScratchFolder folder;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe"),
                              result = folder / "result.json", said = folder / "said.txt";
  const std::vector<std::string> words{
      "env",
      "--chdir",
      kCameFrom.string(),
      "NO_FAKE_STAT=1",
      "LD_PRELOAD=" + (program.parent_path() / "libslowed_waits.so").string(),
      "faketime",
      "-f",
      fmt::format("+0 x{}", speed),
      program.string(),
      std::string("--gtest_filter=") + test->test_suite_name() + "." + test->name(),
      "--gtest_output=json:" + result.string()};
  const auto pointers = [](const std::vector<std::string>& texts) {
    std::vector<char*> all;
    for (const std::string& text : texts) all.push_back(const_cast<char*>(text.c_str()));
    all.push_back(nullptr);
    return all;
  };
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, said.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t own_group;
  posix_spawnattr_init(&own_group);
  posix_spawnattr_setflags(&own_group, POSIX_SPAWN_SETPGROUP);
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  const std::vector<pid_t> own = children();
  pid_t child = -1;
  if (posix_spawnp(&child, "env", &files, &own_group, pointers(words).data(),
                   pointers(kEnvironment).data()) != 0)
    return Repeated::Skipped;
  const std::optional<int> status = status_of(child, until);
  end_orphans(own);
  const std::string told = read_file_if_present(result);
  const bool ran =
      status && WIFEXITED(*status) && WEXITSTATUS(*status) < 125;  // faketime and env could run it
  const auto has = [&](const char* one) {
    return told.find(fmt::format("\"result\": \"{}\"", one)) != told.npos;
  };
  Repeated repeated = Repeated::Failed;
  if (!ran || (*status == 0 && has("SKIPPED")))
    repeated = Repeated::Skipped;
  else if (*status == 0 && has("COMPLETED"))
    repeated = Repeated::Passed;
  if (repeated != Repeated::Skipped) fmt::print("{}, at {:g} of its speed\n", kJudgedWithSlowedClock, speed);
  // Marked, since ctest reads "SKIPPED" as the result of the test that it runs.
  std::istringstream lines(read_file_if_present(said));
  for (std::string line; std::getline(lines, line);) {
    if (const std::size_t at = line.find("SKIPPED"); at != std::string::npos) line.replace(at, 7, "skipped");
    fmt::print("| {}\n", line);
  }
  return repeated;
}

// At the first speed that judges it. Ends before the time limit of ctest does, and in the seconds that
// whoever has to end in time leaves for it: REPEATS_UNTIL, in seconds since 1970.
inline Repeated repeat_with_slowed_clock() {
  using namespace std::chrono;
  auto longest = duration_cast<steady_clock::duration>(480s);
  if (const char* until_s = std::getenv("REPEATS_UNTIL"))
    longest =
        std::min(longest, duration_cast<steady_clock::duration>(
                              system_clock::time_point(seconds(std::atoll(until_s))) - system_clock::now()));
  const Moment until = steady_clock::now() + longest;
  for (const double speed : kClockSpeeds) {
    if (steady_clock::now() >= until) break;
    if (const Repeated repeated = repeat_with_clock_at(speed, until); repeated != Repeated::Skipped)
      return repeated;
  }
  return Repeated::Skipped;
}

}  // namespace biopsy::live_tests
