// The interlock process between two others that are killed or stopped, in real time; stalls of the machine
// are measured beside it and added to the limit.
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/digital_io/interlock_relay.hpp"
#include "drivers/digital_io/io_views.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "tests/drivers/digital_io/high_voltage.hpp"
#include "tests/robot/live/host_watch.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::digital_io {
namespace {

using realtime::monotonic_ns;

const std::string kInterlock = (binary_dir() / "biopsy-interlock").string();
constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kLimit = 20 * kMillisecond;
constexpr std::int64_t kPeriod_ns = std::chrono::nanoseconds(kRelayPeriod).count();
constexpr std::size_t kEvents = 20;
constexpr std::int32_t kDrive_mV = 6'000'000;

std::int64_t host_late_ns(const live_tests::HostWatch& host) {
  return static_cast<std::int64_t>(host.worst_ms() * 1e6);
}

void pause_us(int us) {
  std::this_thread::sleep_for(std::chrono::microseconds(us));
}

// A process of the test, killed with it.
class Child {
 public:
  explicit Child(const std::function<void()>& run) : pid_(::fork()) {
    if (pid_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    run();
    ::_exit(0);
  }
  ~Child() { end(SIGKILL); }
  Child(Child&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}
  Child& operator=(Child&& other) noexcept {
    end(SIGKILL);
    pid_ = std::exchange(other.pid_, -1);
    return *this;
  }

  void send(int signal) const { ::kill(pid_, signal); }
  int end(int signal) {  // wait status
    int status = 0;
    if (pid_ <= 0) return status;
    send(signal);
    ::waitpid(std::exchange(pid_, -1), &status, 0);
    return status;
  }

 private:
  pid_t pid_;
};

class InterlockProcess : public testing::Test {
 protected:
  InterlockProcess() : reader_((create_shared_io(folder_.path()), folder_.path())) {}

  Child relay() const {
    return Child([this] {
      ::execl(kInterlock.c_str(), "biopsy-interlock", folder_.path().c_str(), nullptr);
      ::_exit(127);
    });
  }
  Child stage() const {
    return Child([this] {
      StageIo io(folder_.path());
      const safety::GatedVoltage voltage = high_voltage(kDrive_mV);
      realtime::TickClock clock{std::chrono::milliseconds(1)};
      for (;; clock.wait()) io.write(voltage), io.pulse();
    });
  }
  Child supervisor() const {
    return Child([this] {
      SupervisorIo io(folder_.path());
      realtime::TickClock clock{std::chrono::milliseconds(1)};
      for (;; clock.wait()) io.pulse();
    });
  }

  bool wait_for(const std::function<bool()>& reached) const {
    for (int i = 0; i < 20'000; ++i, pause_us(100))
      if (reached()) return true;
    return false;
  }
  std::int32_t load_mV() const { return reader_.relay().output.load_mV; }
  bool is_driven() const { return load_mV() == kDrive_mV; }

  // From `signal` to `victim` until the relay says 0 V; below 0 if the load had fallen before, or if this
  // process was held up in sending.
  std::int64_t time_to_zero(const Child& victim, int signal) {
    EXPECT_TRUE(wait_for([this] { return is_driven(); }));
    pause_us(std::uniform_int_distribution<int>(0, 5'000)(random_));
    const std::int64_t event_ns = monotonic_ns();
    victim.send(signal);
    const bool held_up = monotonic_ns() - event_ns > kMillisecond / 10;
    EXPECT_TRUE(wait_for([this] { return load_mV() == 0; }));
    const std::int64_t zero_ns = reader_.relay().zero_ns - event_ns;
    EXPECT_EQ(reader_.converter(), (ConverterOutput{kDrive_mV, true})) << "the converter holds its value";
    pause_us(2'000);
    EXPECT_EQ(load_mV(), 0) << "and the load stays off";
    return held_up ? -1 : zero_ns;
  }

  ScratchFolder folder_;
  IoReader reader_;
  std::mt19937 random_{17};
};

void report(const char* event, std::vector<std::int64_t> times_ns, std::int64_t jitter_ns) {
  std::sort(times_ns.begin(), times_ns.end());
  std::printf("%-20s to 0 V: p50 %.2f ms, max %.2f ms (%zu events; host late by up to %.2f ms)\n", event,
              static_cast<double>(times_ns[times_ns.size() / 2]) * 1e-6,
              static_cast<double>(times_ns.back()) * 1e-6, times_ns.size(),
              static_cast<double>(jitter_ns) * 1e-6);
}

struct Event {
  const char* name;
  bool stage;  // else the supervisor
  int signal;
};
class InterlockEvent : public InterlockProcess, public testing::WithParamInterface<Event> {};

TEST_P(InterlockEvent, TakesTheVoltageOffWithinTwentyMilliseconds) {
  verifies("R-43");
  const live_tests::HostWatch host;
  const Child guard = relay();
  Child stage = this->stage(), supervisor = this->supervisor();
  Child& victim = GetParam().stage ? stage : supervisor;
  std::vector<std::int64_t> times_ns;
  // An event during which this process was held up is repeated.
  for (std::size_t tries = 0; times_ns.size() < kEvents && tries < 2 * kEvents && !HasFailure(); ++tries) {
    const std::int64_t time_ns = time_to_zero(victim, GetParam().signal);
    if (time_ns >= 0) times_ns.push_back(time_ns);
    victim.send(SIGCONT);
    if (GetParam().signal != SIGKILL) continue;
    victim.end(SIGKILL);
    victim = GetParam().stage ? this->stage() : this->supervisor();
  }
  ASSERT_EQ(times_ns.size(), kEvents);
  report(GetParam().name, times_ns, host_late_ns(host));
  EXPECT_LE(*std::max_element(times_ns.begin(), times_ns.end()), kLimit + kPeriod_ns + host_late_ns(host));
}

INSTANTIATE_TEST_SUITE_P(Each, InterlockEvent,
                         testing::Values(Event{"stage stopped", true, SIGSTOP},
                                         Event{"stage killed", true, SIGKILL},
                                         Event{"supervisor stopped", false, SIGSTOP},
                                         Event{"supervisor killed", false, SIGKILL}),
                         [](const auto& event) {
                           std::string name = event.param.name;
                           name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
                           return name;
                         });

TEST_F(InterlockProcess, StaysOpenAfterARestartUntilBothFeed) {
  const Child guard = relay();
  Child stage = this->stage();
  Child supervisor = this->supervisor();
  ASSERT_TRUE(wait_for([this] { return is_driven(); }));
  supervisor.end(SIGKILL);
  ASSERT_TRUE(wait_for([this] { return load_mV() == 0; }));
  stage.end(SIGKILL);
  stage = this->stage();
  const std::uint64_t pulses = reader_.stage_pulses();
  ASSERT_TRUE(wait_for([&] { return reader_.stage_pulses() > pulses + 10; }));
  EXPECT_FALSE(reader_.relay().output.closed);
  supervisor = this->supervisor();
  EXPECT_TRUE(wait_for([this] { return is_driven(); }));
}

TEST_F(InterlockProcess, WhenStoppedOrKilledItselfIsSeenOpenByTheReader) {
  const live_tests::HostWatch host;
  const Child stage = this->stage(), supervisor = this->supervisor();
  for (const int signal : {SIGSTOP, SIGKILL}) {
    Child guard = relay();
    ASSERT_TRUE(wait_for([this] { return reader_.load_voltage_seen_mV(monotonic_ns()) == kDrive_mV; }));
    const std::int64_t event_ns = monotonic_ns();
    guard.send(signal);
    ASSERT_TRUE(wait_for([this] { return reader_.load_voltage_seen_mV(monotonic_ns()) == 0; }));
    EXPECT_LE(monotonic_ns() - event_ns, kLimit + kMillisecond + host_late_ns(host));
    EXPECT_TRUE(is_driven()) << "its last output, which no longer counts";
  }
}

TEST_F(InterlockProcess, OpensBeforeItEnds) {
  const Child stage = this->stage(), supervisor = this->supervisor();
  for (const int signal : {SIGTERM, SIGINT}) {
    Child guard = relay();
    ASSERT_TRUE(wait_for([this] { return is_driven(); }));
    const int status = guard.end(signal);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    EXPECT_EQ(reader_.relay().output, RelayOutput{});
  }
}

TEST_F(InterlockProcess, RefusesToStartWithoutLinesOrBesideAnother) {
  const Child first = relay();
  ASSERT_TRUE(wait_for([this] { return reader_.relay().ticks > 0; }));
  for (const char* folder : {folder_.path().c_str(), "/nowhere"}) {
    Child second([folder] {
      std::freopen("/dev/null", "w", stderr);
      ::execl(kInterlock.c_str(), "biopsy-interlock", folder, nullptr);
    });
    const int status = second.end(0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 2) << folder;
  }
}

}  // namespace
}  // namespace biopsy::digital_io
