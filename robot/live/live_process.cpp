#include "robot/live/live_process.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <exception>

#include "robot/common/config_error.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/security/check_keys.hpp"
#include "robot/security/cyclone_xml.hpp"

namespace biopsy::live {
namespace {

// Only what is in the loop comes before other programs: the recorder is to wait for it, not it for the
// recorder.
std::string precedence_obtained(int fifo_priority, security::Role role) {
  if (role == security::Role::Recorder) fifo_priority = 0;
  const auto asked = realtime::RealtimeSettings{
      .lock_memory = false, .fifo_priority = fifo_priority, .threads_inherit = true, .cpu = std::nullopt};
  return fifo_priority == 0 ? "ordinary scheduling" : realtime::to_text(realtime::become_realtime(asked));
}

}  // namespace

transport::BusSettings bus_settings(const LiveSettings& settings, security::Role role) {
  security::CycloneOptions options;
  options.interface = settings.network;
  if (!settings.keys.empty()) {
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    security::check_keys(settings.keys, role, now);
    options.security = security::Security{settings.keys, role};
  }
  return {settings.domain, security::cyclone_xml(options), settings.robot};
}

transport::BusSettings plain_settings(const LiveSettings& settings) {
  constexpr std::uint32_t kBeyondAllDomains = 1'000;
  security::CycloneOptions options;
  options.interface = settings.network;
  options.domain_on_wire = static_cast<int>(settings.domain);
  return {settings.domain + kBeyondAllDomains, security::cyclone_xml(options), settings.robot};
}

LiveProcess::LiveProcess(const std::filesystem::path& run_folder, security::Role role)
    : settings_(read_settings(run_folder)),
      config_tag_(live::config_tag(run_folder, settings_)),
      precedence_(precedence_obtained(settings_.fifo_priority, role)),
      bus_(bus_settings(settings_, role)) {}

void LiveProcess::start_ticking() {
  const realtime::RealtimeObtained obtained =
      realtime::become_realtime({.lock_memory = true, .cpu = std::nullopt});
  fmt::print("started; {}; {}\n", precedence_, realtime::to_text(obtained));
  std::fflush(stdout);
  notice_.ready();
}

void LiveProcess::stroke_watchdog(std::int64_t now_us) {
  if (!notice_.watchdog_us() || now_us - stroked_us_ < *notice_.watchdog_us() / 2) return;
  notice_.watchdog();
  stroked_us_ = now_us;
}

int live_main(int argc, char** argv, const char* name, void (*run)(const std::filesystem::path& run_folder)) {
  try {
    if (argc != 2) throw ConfigError("wants one argument", name, fmt::format("{} RUN_FOLDER", name));
    run(argv[1]);
    return 0;
  } catch (const ConfigError& error) {
    fmt::print(stderr, "error: {}\nwhere: {}\nto do: {}\n", error.what_is_wrong, error.where, error.remedy);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\nwhere: {}\nto do: report this with what led to it\n", error.what(), name);
  }
  return 2;
}

}  // namespace biopsy::live
