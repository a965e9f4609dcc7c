#include "robot/live/config_watch.hpp"

#include <pthread.h>

#include <chrono>

#include "robot/common/config_error.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::live {
namespace {

constexpr std::chrono::milliseconds kEvery{500};

std::int64_t now_us() {
  return realtime::monotonic_ns() / 1000;
}

}  // namespace

ConfigWatch::ConfigWatch(std::filesystem::path run_folder, LiveSettings settings)
    : run_folder_(std::move(run_folder)), settings_(std::move(settings)) {
  read(now_us());
  thread_ = std::jthread([this](const std::stop_token& stop) {
    const sched_param ordinary{};  // it would inherit the priority of the loop, and reads files
    ::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &ordinary);
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, stop, kEvery, [] { return false; }) && !stop.stop_requested())
      read(now_us());
  });
}

void ConfigWatch::read(std::int64_t now_us) {
  try {
    files_.set(config_tag(run_folder_, settings_), now_us);
  } catch (const ConfigError&) {
    files_.set(0, now_us);
  }
}

}  // namespace biopsy::live
