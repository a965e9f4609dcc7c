// on_steady_host [--patience S] [--slowed LIBRARY] COMMAND [ARGUMENT ...]: runs a command that judges a robot
// in real time, and watches this machine meanwhile. The exit code is the command's; but 77, "not judged",
// where it failed, or came to no end in S seconds (120), on a machine that stood still so often that three
// tries of ten seconds all meet a stall in more than one case of twenty; without --patience it is given half
// a minute only, where they meet one in nearly every case. A command that ends with 4 says that its failure
// is not one of time: that is judged on any machine. With --slowed a command that was not judged runs once
// more, with four times the patience (at once, where that half minute tells it), and is told by
// CLOCK_SPEED=0.25 in its environment to slow the clocks of its robot; SLOWED_WAITS is the library
// (slowed_waits) that this takes. REPEATS_UNTIL, in seconds since 1970, ends that run.
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <string_view>
#include <thread>

#include "robot/live/realtime/tick_clock.hpp"
#include "tests/robot/live/host_watch.hpp"

namespace biopsy::live_tests {
namespace {

constexpr double kOften_s = 20.0;    // between stalls: (1 - exp(-10 / 20))^3 = 0.06
constexpr double kHopeless_s = 2.0;  // between stalls: (1 - exp(-10 / 2))^3 = 0.98
constexpr double kLook_s = 30.0;     // to tell that
constexpr double kPatience_s = 120.0, kPatienceMax_s = 3600.0, kToEnd_s = 15.0;
constexpr int kNotJudged = 77, kNotOfTime = 4;

pid_t group = 0;  // the command's

void pass_on(int signal) {
  kill(-group, signal);
}

// Whether the child, the first of its group, has ended by then.
bool ends(pid_t child, int& status, const auto& goes_on) {
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (!goes_on()) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return true;
}

int run(char* const* command, double patience_s, bool gives_up) {
  pid_t child = -1;
  posix_spawnattr_t own_group;
  posix_spawnattr_init(&own_group);
  posix_spawnattr_setflags(&own_group, POSIX_SPAWN_SETPGROUP);
  if (posix_spawnp(&child, command[0], nullptr, &own_group, command, environ) != 0) {
    fmt::print(stderr, "error: {}: cannot be started\n", command[0]);
    return 2;
  }
  group = child;
  std::signal(SIGINT, pass_on);
  std::signal(SIGTERM, pass_on);
  const std::int64_t began_ns = realtime::monotonic_ns();
  const auto seconds = [&] { return static_cast<double>(realtime::monotonic_ns() - began_ns) * 1e-9; };
  const HostWatch host;
  const auto is_steady = [&] { return host.stalls() * kOften_s < seconds(); };
  const auto is_hopeless = [&] { return seconds() > kLook_s && host.stalls() * kHopeless_s > seconds(); };
  int status = 0;
  const bool ended = ends(
      child, status, [&] { return (seconds() < patience_s || is_steady()) && !(gives_up && is_hopeless()); });
  const bool steady = is_steady();
  fmt::print("this machine stood still {} times in {:.0f} s, for {:.1f} ms at most\n", host.stalls(),
             seconds(), host.worst_ms());
  if (!ended) {
    const double asked_s = seconds();
    kill(-child, SIGINT);
    if (!ends(child, status, [&] { return seconds() < asked_s + kToEnd_s; })) {
      kill(-child, SIGKILL);
      waitpid(child, &status, 0);
    }
  }
  const int code = ended && WIFEXITED(status) ? WEXITSTATUS(status) : 1;
  if (code == 0 || code == kNotOfTime || steady) return code;
  fmt::print("not judged: a robot in real time stops by itself on such a machine\n");
  return kNotJudged;
}

}  // namespace
}  // namespace biopsy::live_tests

int main(int count, char** words) {
  using namespace biopsy::live_tests;
  double patience_s = kPatience_s;
  bool is_patient = false;
  const char* slowed = nullptr;
  int at = 1;
  for (; at + 2 < count; at += 2) {
    if (std::string_view(words[at]) == "--patience")
      patience_s = std::atof(words[at + 1]), is_patient = true;
    else if (std::string_view(words[at]) == "--slowed")
      slowed = words[at + 1];
    else
      break;
  }
  if (at >= count || !(patience_s > 0.0 && patience_s <= kPatienceMax_s)) {
    fmt::print(
        stderr,
        "usage: on_steady_host [--patience S] [--slowed LIBRARY] COMMAND [ARGUMENT ...], S up to {:g} s\n",
        kPatienceMax_s);
    return 2;
  }
  const int code = run(words + at, patience_s, slowed != nullptr || !is_patient);
  if (code != kNotJudged || slowed == nullptr) return code;
  setenv("CLOCK_SPEED", fmt::format("{}", kClockSpeeds.front()).c_str(), 1);
  setenv("SLOWED_WAITS", slowed, 1);
  double slowed_patience_s = patience_s / kClockSpeeds.front();
  if (const char* until_s = std::getenv("REPEATS_UNTIL"))
    slowed_patience_s =
        std::min(slowed_patience_s, std::atof(until_s) - static_cast<double>(std::time(nullptr)));
  if (slowed_patience_s <= 0.0) return code;
  const int again = run(words + at, slowed_patience_s, false);
  if (again != kNotJudged) fmt::print("{}\n", kJudgedWithSlowedClock);
  return again;
}
