// Figures of the live robot, beside what the machine and the bare bus take: ./dev bench live.
//   events  every process killed and stopped at random moments: time to 0 V
//   loop    measurement to request, beside a raw round trip of the same payload
//   soak    minutes of rehearsal: trips that nobody caused
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <map>
#include <random>

#include "robot/common/files/output_folder.hpp"
#include "robot/procedure/case/case.hpp"
#include "tests/bench/live_loop.hpp"
#include "tests/bench/live_soak.hpp"
#include "tests/robot/live/live_events.hpp"
#include "tests/scratch_folder.hpp"

namespace {

using namespace biopsy;

struct Asked {
  std::vector<std::string> what{"loop", "events", "soak"};
  int events = 50;
  std::string only;  // of the events: "recorder", "recorder stop"
  double minutes = 30.0;
  robot::LiveOptions live;
};

double at_share(std::vector<double> values, double share) {
  if (values.empty()) return -1.0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

// What safety.md and the issue allow, ms; the log has a second of backlog and a ramp.
double allowed_ms(Process victim) {
  if (victim == Process::Stage) return 20.0;
  return victim == Process::Recorder ? 1'500.0 : 10.0;
}

void bench_events(const Asked& asked, const robot::PreparedCase& prepared) {
  fmt::print("\nTime from the event to 0 V on the stack, ms ({} events each)\n", asked.events);
  fmt::print("{:<12}{:<9}{:>7}{:>9}{:>9}{:>9}{:>10}{:>8}{:>12}\n", "process", "signal", "events", "p50",
             "p99", "max", "allowed", "over", "host, max");
  std::mt19937 random(1);
  for (const Process victim : {Process::Supervisor, Process::Controller, Process::Stage, Process::Recorder})
    for (const int signal : {SIGKILL, SIGSTOP}) {
      const std::string kind = fmt::format("{} {}", name_of(victim), signal == SIGKILL ? "kill" : "stop");
      if (kind.find(asked.only) == std::string::npos) continue;
      std::vector<double> times, host;
      double unpermitted_ms = 0.0;
      int not_counted = 0;
      int over = 0, over_host = 0, never = 0;
      // A robot that stopped before its event is none of them: another takes its place.
      for (int n = 0; n < 2 * asked.events && std::ssize(times) < asked.events; ++n) {
        const ScratchFolder folder;
        const live_tests::LiveEvent event{victim, signal, static_cast<std::int64_t>(random() % 3'000)};
        const std::int64_t watch_ms = victim == Process::Recorder ? 2'000 : 400;
        const live_tests::EventOutcome outcome =
            live_tests::live_event(event, asked.live, prepared, folder.path(), watch_ms);
        if (!outcome.trouble.empty()) {
          ++not_counted;
          continue;
        }
        unpermitted_ms = std::max(unpermitted_ms, outcome.unpermitted_ms);
        never += outcome.to_zero_ms < 0.0;
        times.push_back(outcome.to_zero_ms);
        host.push_back(outcome.host_late_ms);
        const bool is_over = outcome.to_zero_ms < 0.0 || outcome.to_zero_ms > allowed_ms(victim);
        over += is_over;
        over_host += is_over && outcome.host_late_ms > 1.0;
      }
      fmt::print("{:<12}{:<9}{:>7}{:>9.2f}{:>9.2f}{:>9.2f}{:>10.0f}{:>8}{:>12.2f}", name_of(victim),
                 signal == SIGKILL ? "kill -9" : "stop", times.size(), at_share(times, 0.5),
                 at_share(times, 0.99), at_share(times, 1.0), allowed_ms(victim), over, at_share(host, 1.0));
      if (over > 0) fmt::print("   ({} with the host late by > 1 ms)", over_host);
      if (never > 0) fmt::print("   STAYED ON: {}", never);
      fmt::print("\n{:21}after the supervisor's last pulse {:.2f} at most; {} stopped before their event\n",
                 "", unpermitted_ms, not_counted);
      std::fflush(stdout);
    }
}

// The established judge of a host's jitter, beside everything that is measured here.
class Cyclictest {
 public:
  Cyclictest() : there_(std::system("command -v cyclictest >/dev/null") == 0) {
    if (there_)
      there_ =
          std::system("cyclictest -S -q -p 85 -i 500 -D 10h > /dev/shm/biopsy-cyclictest.txt 2>&1 & ") == 0;
  }
  ~Cyclictest() {
    if (!there_) {
      fmt::print("\ncyclictest is not installed (package rt-tests)\n");
      return;
    }
    [[maybe_unused]] const int ended = std::system("pkill -INT cyclictest; sleep 1");
    fmt::print("\ncyclictest -S -p 85 -i 500, all the while:\n{}\n",
               file_content("/dev/shm/biopsy-cyclictest.txt"));
    std::filesystem::remove("/dev/shm/biopsy-cyclictest.txt");
  }
  Cyclictest(const Cyclictest&) = delete;
  Cyclictest& operator=(const Cyclictest&) = delete;

 private:
  bool there_;
};

}  // namespace

int main(int argc, char** argv) {
  Asked asked;
  asked.live.domain = 90;
  asked.live.without_security = false;
  CLI::App app{"live robot: real processes"};
  app.add_option("WHAT", asked.what, "loop, events, soak (default: all)");
  app.add_option("--events", asked.events, "of each kind (default 50)");
  app.add_option("--only", asked.only, "events whose kind contains this, as \"recorder stop\"");
  app.add_option("--minutes", asked.minutes, "of the soak (default 30)");
  app.add_option("--domain", asked.live.domain, "DDS domain");
  app.add_flag("--without-security", asked.live.without_security, "plain bus");
  CLI11_PARSE(app, argc, argv);
  const Cyclictest host;
  const ScratchFolder folder;
  const robot::PreparedCase prepared = robot::prepare(robot::read_case("gap"), folder.path());
  for (const std::string& what : asked.what) {
    if (what == "events") bench_events(asked, prepared);
    if (what == "loop") bench::bench_loop(asked.live);
    if (what == "soak") bench::bench_soak(asked.live, prepared, asked.minutes);
  }
  return 0;
}
