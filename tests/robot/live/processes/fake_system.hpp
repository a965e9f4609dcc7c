// The operating system of a test, linked in place of the C library's: processes that are never started, an
// owner that is only noted, a program that lies in a folder of the test, time that passes without waiting.
// Where no FakeSystem lives, the C library answers.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace biopsy::fake_system {

inline constexpr int kNever = -1;

constexpr int ended_with(int code) {
  return code << 8;
}

// A process that was started.
struct Child {
  std::optional<int> status;           // of waitpid, once it ended
  int on_term = ended_with(0);         // it ends so after SIGTERM; kNever: it is deaf to it
  int on_kill = 9;                     // and after SIGKILL
  std::chrono::milliseconds takes{0};  // until it ended, from then
  std::chrono::nanoseconds ends_at{-1};
  int ends_with = 0;
};

struct Given {  // fchown and fchmod
  std::filesystem::path path;
  uid_t user = 0;
  gid_t group = 0;
};

class FakeSystem {
 public:
  // `program`: the file that this program is said to be.
  explicit FakeSystem(std::filesystem::path program);
  ~FakeSystem();
  FakeSystem(const FakeSystem&) = delete;
  FakeSystem& operator=(const FakeSystem&) = delete;

  std::filesystem::path program;
  bool starts_real_processes = false;
  bool no_more_processes = false;    // fork fails
  std::function<void()> on_prctl;    // before it
  std::optional<pid_t> parent;       // that getppid tells
  std::map<pid_t, Child> children;   // that were not collected
  std::vector<pid_t> started;        // in order
  std::vector<std::string> signals;  // "TERM 5000001", in order
  std::chrono::nanoseconds now{0};   // slept so far
  std::function<void()> on_sleep;    // after it
  std::vector<Given> given;
  bool may_give = true, may_change_mode = true;
  std::optional<uid_t> user;  // that getuid tells
};

// nullptr: none lives.
FakeSystem* present();

}  // namespace biopsy::fake_system
