#include "robot/live/config_watch.hpp"

#include <pthread.h>

#include <chrono>

#include "robot/common/config_error.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::live {
namespace {

constexpr std::chrono::milliseconds kEvery{500}, kLook{10};  // a person does not feel the latter

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
    for (auto waited = kLook; !stop.stop_requested(); waited += kLook) {
      std::this_thread::sleep_for(kLook);
      if (!files_.take_request() && waited < kEvery) continue;
      read(now_us());
      waited = {};
    }
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
