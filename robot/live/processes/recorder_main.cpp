// biopsy-recorder RUN_FOLDER: writes the procedure log, off the control path.
#include <chrono>
#include <optional>
#include <string>

#include "robot/common/logging/logger.hpp"
#include "robot/live/bus_recorder.hpp"
#include "robot/live/live_process.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "robot/security/key_files.hpp"

namespace {

using namespace biopsy;

constexpr logging::Logger kLog{logging::Component::Recorder};
constexpr std::chrono::milliseconds kPeriod{10};

void record(const std::filesystem::path& run_folder) {
  live::LiveProcess process(run_folder, security::Role::Recorder);
  const live::LiveSettings& settings = process.settings();
  SigningKey key(settings.log_key);
  recorder::Recorder recorder(live::own_folder(run_folder) / settings.log, std::move(key));
  std::optional<transport::ParticipantMonitor> participants;
  if (!settings.keys.empty()) participants.emplace(live::plain_settings(settings), process.bus());
  robot::BusRecorder bus_recorder(process.bus(), recorder, process.config_tag(),
                                  participants ? &*participants : nullptr);
  const auto now_us = [] { return realtime::monotonic_ns() / 1000; };
  bus_recorder.note(recorder::RecordKind::ProcessStart, "{}", now_us());
  process.start_ticking();
  realtime::TickClock clock(kPeriod);
  std::string trouble;  // as logged
  while (!process.stop_asked()) {
    bus_recorder.turn(clock.wait().woke_ns / 1000);
    process.after_tick(now_us(), bus_recorder.health());
    if (recorder.last_error() != trouble)
      kLog.warning("procedure log: {}",
                   recorder.last_error().empty() ? "written again" : recorder.last_error());
    trouble = recorder.last_error();
  }
  bus_recorder.turn(now_us());
  bus_recorder.note(recorder::RecordKind::ProcessStop, "{}", now_us());
  recorder.flush(now_us());
}

}  // namespace

int main(int argc, char** argv) {
  return live::live_main(argc, argv, "recorder", record);
}
