#include "robot/live/live_process.hpp"

#include <algorithm>
#include <chrono>

#include "robot/common/logging/logger.hpp"
#include "robot/common/logging/program.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/security/check_keys.hpp"
#include "robot/security/cyclone_xml.hpp"

namespace biopsy::live {
namespace {

constexpr logging::TickEvent kOverrun{logging::Level::Info,
                                      "periods missed: {0:.0f}, since the start {1:.0f}"};
constexpr logging::TickEvent kRefused{
    logging::Level::Warning, "messages of participants without keys: {0:.0f}, since the start {1:.0f}"};

logging::Component component_of(security::Role role) {
  const auto& names = logging::kComponentNames;
  const auto* found = std::find(names.begin(), names.end(), name_of(role));
  return static_cast<logging::Component>(found - names.begin());
}

// Real-time priority for the loop only: the recorder waits for the loop, never the reverse.
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
    : tick_log_(component_of(role)),
      logger_(component_of(role)),
      settings_(read_settings(run_folder)),
      config_tag_(live::config_tag(run_folder, settings_)),
      precedence_(precedence_obtained(settings_.fifo_priority, role)),
      bus_(bus_settings(settings_, role)) {}

void LiveProcess::start_ticking() {
  const realtime::RealtimeObtained obtained =
      realtime::become_realtime({.lock_memory = true, .cpu = std::nullopt});
  logger_.info("started; {}; {}", precedence_, realtime::to_text(obtained));
  notice_.ready();
}

void LiveProcess::after_tick(std::int64_t now_us, const Health& health) {
  const auto log_more = [&](std::uint32_t now, std::uint32_t& logged, const logging::TickEvent& event) {
    if (now != logged) tick_log_.record(event, now_us, now - logged, now);
    logged = now;
  };
  log_more(health.overruns, overruns_, kOverrun);
  log_more(health.refused, refused_, kRefused);
  if (!notice_.watchdog_us() || now_us - stroked_us_ < *notice_.watchdog_us() / 2) return;
  if (notice_.watchdog()) stroked_us_ = now_us;  // no room: again with the next tick
}

int live_main(int argc, char** argv, const std::string& name,
              void (*run)(const std::filesystem::path& run_folder)) {
  const std::string program = "biopsy-" + name;
  return logging::run_program(program, [&] {
    logging::ProgramArguments arguments = logging::parse_arguments(program, argc, argv);
    if (arguments.log.file.empty()) arguments.log.file = own_folder(arguments.folder) / (name + ".log");
    const logging::LogSession log(arguments.log);
    run(arguments.folder);
    return 0;
  });
}

}  // namespace biopsy::live
