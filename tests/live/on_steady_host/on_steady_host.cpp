// on_steady_host COMMAND [ARGUMENT ...]: runs a command that judges a robot in real time, and watches this
// machine meanwhile. The exit code is the command's; but 77, "not judged", where it failed on a machine that
// stood still so often that three tries of ten seconds all meet a stall in more than one case of twenty.
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "robot/realtime/tick_clock.hpp"
#include "tests/live/host_watch.hpp"

namespace biopsy::live_tests {
namespace {

constexpr double kOften_s = 20.0;  // between stalls: (1 - exp(-10 / 20))^3 = 0.06
constexpr int kNotJudged = 77;

int run(char* const* command) {
  pid_t child = -1;
  if (posix_spawnp(&child, command[0], nullptr, nullptr, command, environ) != 0) {
    fmt::print(stderr, "error: {}: cannot be started\n", command[0]);
    return 2;
  }
  const std::int64_t began_ns = realtime::monotonic_ns();
  const HostWatch host;
  int status = 0;
  waitpid(child, &status, 0);
  const double ran_s = static_cast<double>(realtime::monotonic_ns() - began_ns) * 1e-9;
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
  fmt::print("this machine stood still {} times in {:.0f} s, for {:.1f} ms at most\n", host.stalls(), ran_s,
             host.worst_ms());
  if (code == 0 || host.stalls() * kOften_s < ran_s) return code;
  fmt::print("not judged: a robot in real time stops by itself on such a machine\n");
  return kNotJudged;
}

}  // namespace
}  // namespace biopsy::live_tests

int main(int count, char** words) {
  if (count > 1) return biopsy::live_tests::run(words + 1);
  fmt::print(stderr, "usage: on_steady_host COMMAND [ARGUMENT ...]\n");
  return 2;
}
