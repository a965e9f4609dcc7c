// Start and end of every process of the live robot.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "robot/common/logging/logger.hpp"
#include "robot/common/logging/tick_log.hpp"
#include "robot/live/live_settings.hpp"
#include "robot/live/realtime/service_notice.hpp"
#include "robot/live/realtime/stop_signals.hpp"
#include "robot/msg/topics.hpp"
#include "robot/transport/bus.hpp"

namespace biopsy::live {

// Bus configuration from the settings. The keys are verified first. Throws ConfigError naming the file.
transport::BusSettings bus_settings(const LiveSettings& settings, security::Role role);

// The same network without security, under a domain id that the bus does not use.
transport::BusSettings plain_settings(const LiveSettings& settings);

class LiveProcess {
 public:
  // Reads the settings and joins the bus. Throws ConfigError.
  LiveProcess(const std::filesystem::path& run_folder, security::Role role);

  const LiveSettings& settings() const { return settings_; }
  std::uint64_t config_tag() const { return config_tag_; }
  const transport::Participant& bus() const { return bus_; }

  // From here on ticks are timed: memory is locked where permitted.
  void start_ticking();
  bool stop_asked() { return signals_.came(); }
  // Once a tick, with what the loop reports: strokes systemd's watchdog, and logs missed periods and samples
  // that were refused.
  void after_tick(std::int64_t now_us, const Health& health);
  logging::TickLog& tick_log() { return tick_log_; }

  ~LiveProcess() { notice_.stopping(); }

 private:
  realtime::StopSignals signals_;  // first: later threads inherit the mask
  realtime::ServiceNotice notice_;
  logging::TickLog tick_log_;  // its thread runs at ordinary priority
  logging::Logger logger_;
  LiveSettings settings_;
  std::uint64_t config_tag_;
  std::string precedence_;  // SCHED_FIFO where requested and permitted: before the bus starts its threads
  transport::Participant bus_;
  std::int64_t stroked_us_ = 0;
  std::uint32_t overruns_ = 0, refused_ = 0;  // as logged
};

// main() of a process that takes a run folder and log options. It logs to NAME.log in that folder.
int live_main(int argc, char** argv, const std::string& name,
              void (*run)(const std::filesystem::path& run_folder));

}  // namespace biopsy::live
