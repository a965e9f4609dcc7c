// biopsy-mcap RUN_FOLDER: every topic of a robot that `biopsy up` brought up, in an MCAP file beside its log.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <thread>

#include "robot/cli/command_parsing.hpp"
#include "robot/cli/log_options.hpp"
#include "robot/common/logging/logger.hpp"
#include "robot/common/logging/program.hpp"
#include "robot/live/live_process.hpp"
#include "robot/live/mcap_recorder.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace {

using namespace biopsy;
namespace fs = std::filesystem;

constexpr logging::Logger kLog{logging::Component::Cli};
constexpr std::chrono::milliseconds kPeriod{2};

struct Options {
  fs::path run_folder;
  double rate_Hz = 100.0;
};

std::int64_t wall_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

void record(const Options& options) {
  realtime::StopSignals signals;
  const live::LiveSettings settings = live::read_settings(fs::absolute(options.run_folder));
  realtime::run_in_background();
  const transport::Participant bus(live::bus_settings(settings, security::Role::Mcap));
  const fs::path file = robot::free_mcap_name(live::own_folder(options.run_folder));
  robot::McapRecorder recorder(bus, file, options.rate_Hz, "biopsy-mcap");
  kLog.info("recording to {}", file.string());
  fmt::print("{}\n", file.string());
  std::fflush(stdout);
  for (auto next = std::chrono::steady_clock::now(); !signals.came(); std::this_thread::sleep_until(next)) {
    recorder.turn(realtime::monotonic_ns() / 1000, wall_ns());
    next = std::max(next + kPeriod, std::chrono::steady_clock::now());
  }
  recorder.turn(realtime::monotonic_ns() / 1000, wall_ns());
  recorder.finish();
}

}  // namespace

int main(int argc, char** argv) {
  return logging::run_program("biopsy-mcap", [&] {
    Options options;
    CLI::App command(
        "Records every topic of a robot that `biopsy up` brought up in an MCAP file; it only reads");
    command.add_option("RUN_FOLDER", options.run_folder, "of the robot: holds live.json")->required();
    command
        .add_option("--rate", options.rate_Hz,
                    "at most so many messages a second of a topic that is sent every tick (default: 100)")
        ->check(robot::in_range(1.0, 1000.0, "Hz"));
    std::string level, format;
    robot::log_options(command, level, format);
    if (!robot::parse_arguments(command, "biopsy-mcap", argc, argv)) return 0;
    logging::LogSettings log = robot::log_settings("biopsy-mcap", level, format);
    log.file = live::own_folder(options.run_folder) / "mcap.log";
    const logging::LogSession session(log);
    record(options);
    return 0;
  });
}
