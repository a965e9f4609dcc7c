// A process of the live robot, run from its main() to its end in this one: over a fake bus, a fake machine
// and the functions of a fake cycle; systemd's end of its socket is the test's.
#pragma once

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "robot/live/live_settings.hpp"
#include "tests/key_files.hpp"
#include "tests/robot/live/loops/bench.hpp"
#include "tests/robot/live/processes/fake_machine.hpp"
#include "tests/source_dir.hpp"

// Their main() under names of their own.
int controller_main(int argc, char** argv);
int interlock_main(int argc, char** argv);
int recorder_main(int argc, char** argv);
int stage_main(int argc, char** argv);
int supervisor_main(int argc, char** argv);

namespace biopsy::processes_tests {

namespace fs = std::filesystem;
using loops_tests::kStart_us;
constexpr double kLogged_us =
    5'000;  // to which the log tells a time, and what two clocks of the machine differ meanwhile
using Notices = std::vector<std::string>;

class Systemd {
 public:
  explicit Systemd(const std::string& name) : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, name.data(), name.size());
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0) << name;
    ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
  }
  ~Systemd() {
    ::close(socket_);
    ::unsetenv("NOTIFY_SOCKET");
    ::unsetenv("WATCHDOG_USEC");
  }
  // As systemd does all the time: ten may be all that wait (net.unix.max_dgram_qlen).
  void receive() {
    char text[256];
    for (ssize_t size = 0; (size = ::recv(socket_, text, sizeof text, MSG_DONTWAIT)) >= 0;)
      received_.emplace_back(text, static_cast<std::size_t>(size));
  }
  // Since the last call.
  Notices notices() {
    receive();
    return std::exchange(received_, {});
  }

 private:
  int socket_;
  Notices received_;
};

struct ProcessBench : loops_tests::LoopBench {
  ProcessBench() {
    fake_machine::state() = {};
    fs::create_directories(folder / "run");
    settings.domain = 7;
    settings.robot = 3;
    settings.network = "eth7";
    settings.lines = folder.path();
    settings.log = "procedure.log.sqlite";
    settings.log_key = folder / "signing_key.pem";
    settings.model = source_dir() / "sim/models/rehearsal.toml";
    settings.tissues = source_dir() / "sim/models/tissues.toml";
    settings.layers = {{"gap", Millimetres(0.0), Millimetres(2.0)},
                       {"muscle", Millimetres(2.0), Millimetres(60.0)}};
    settings.seed = 17;
  }
  void write_settings() const { write_content(folder / "run/live.json", live::to_json(settings)); }
  std::uint64_t tag() const { return live::config_tag(folder / "run", settings); }
  int run(int (*main)(int, char**), std::vector<std::string> words = {}) {
    write_settings();
    words.insert(words.begin(), {"program", (folder / "run").string()});
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    return main(static_cast<int>(pointers.size()), pointers.data());
  }
  // What the process logged: each line without its time.
  std::string log(const std::string& name) const { return file_content(folder / ("run/" + name + ".log")); }
  static void stop() { ::raise(SIGTERM); }
  static int lines_with(const std::string& text, const std::string& part) {
    int count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
  }
  // Time of the first line with `part`, on the processes' clock; of the tick's records only, as these bring
  // theirs.
  static double time_us_of(const std::string& text, const std::string& part) {
    const std::string line = text.substr(text.rfind('\n', text.find(part)) + 1);
    int year = 0, hours = 0, minutes = 0;
    unsigned month = 0, day = 0;
    double seconds = 0.0;
    EXPECT_EQ(
        std::sscanf(line.c_str(), "%d-%u-%uT%d:%d:%lfZ", &year, &month, &day, &hours, &minutes, &seconds), 6)
        << text;
    namespace chr = std::chrono;
    const chr::sys_days date = chr::year(year) / chr::month(month) / chr::day(day);
    const auto begin = chr::system_clock::now() - chr::steady_clock::now().time_since_epoch();
    const auto passed = date + chr::hours(hours) + chr::minutes(minutes) - begin;
    return chr::duration<double, std::micro>(passed).count() + seconds * 1e6;
  }
  // How often the watchdog was stroked.
  int strokes() {
    const Notices all = systemd.notices();
    return static_cast<int>(std::count(all.begin(), all.end(), "WATCHDOG=1"));
  }
  void with_watchdog(std::int64_t us) const { ::setenv("WATCHDOG_USEC", std::to_string(us).c_str(), 1); }

  Systemd systemd{(folder / "notify").string()};
  live::LiveSettings settings;
  fake_machine::State& machine = fake_machine::state();
};

}  // namespace biopsy::processes_tests
