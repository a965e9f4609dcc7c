// biopsy-ros2 RUN_FOLDER: state of a robot that `biopsy up` brought up, as topics of ROS 2.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <thread>

#include "robot/cli/command_parsing.hpp"
#include "robot/cli/log_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/logging/logger.hpp"
#include "robot/common/logging/program.hpp"
#include "robot/live/live_process.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "robot/ros2/bus_observer.hpp"
#include "robot/ros2/state_publisher.hpp"

namespace {

using namespace biopsy;
namespace fs = std::filesystem;

constexpr logging::Logger kLog{logging::Component::Cli};

struct Options {
  fs::path run_folder;
  ros2::RosSettings ros;
  double rate_Hz = 100.0;
};

std::int64_t wall_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

void serve(const Options& options) {
  realtime::StopSignals signals;
  const live::LiveSettings settings = live::read_settings(fs::absolute(options.run_folder));
  if (options.ros.domain == settings.domain)
    throw ConfigError(
        fmt::format("ROS 2 would share DDS domain {} with the robot's own bus", settings.domain),
        "command line", "give the robot another: biopsy up --domain N; or ROS 2: --ros-domain N");
  realtime::run_in_background();
  const transport::Participant bus(live::bus_settings(settings, security::Role::Observer));
  ros2::BusObserver observer(bus);
  ros2::StatePublisher publisher(options.ros, settings.robot);
  const std::string what = fmt::format(
      "ROS 2 domain {}, {}: /joint_states /needle/depth /needle/state/pose "
      "/supervisor/state /diagnostics",
      options.ros.domain, options.ros.enclave.empty() ? "WITHOUT security" : "secured");
  kLog.info("{}", what);
  fmt::print("{}\n", what);
  std::fflush(stdout);
  const std::chrono::nanoseconds period(static_cast<std::int64_t>(1e9 / options.rate_Hz));
  for (auto next = std::chrono::steady_clock::now(); !signals.came(); std::this_thread::sleep_until(next)) {
    const std::int64_t now_us = realtime::monotonic_ns() / 1000;
    publisher.publish(observer.state(now_us), now_us, wall_ns());
    next = std::max(next + period, std::chrono::steady_clock::now());
  }
}

}  // namespace

int main(int argc, char** argv) {
  return logging::run_program("biopsy-ros2", [&] {
    Options options;
    CLI::App command(
        "State of a robot that `biopsy up` brought up, as topics of ROS 2; it listens to nothing there");
    command.add_option("RUN_FOLDER", options.run_folder, "of the robot: holds live.json")->required();
    command.add_option("--ros-domain", options.ros.domain, "of ROS 2 (default: ROS_DOMAIN_ID, or 0)")
        ->envname("ROS_DOMAIN_ID")
        ->check(robot::in_range(0, 230));
    command.add_option("--interface", options.ros.interface,
                       "of the network, such as eth0 (default: this machine only)");
    command.add_option("--enclave", options.ros.enclave,
                       "folder of an enclave of a keystore of ROS 2 (default: without security)");
    command.add_option("--rate", options.rate_Hz, "of depth and pose (default: 100)")
        ->check(robot::in_range(1.0, 1000.0, "Hz"));
    std::string level, format;
    robot::log_options(command, level, format);
    if (!robot::parse_arguments(command, "biopsy-ros2", argc, argv)) return 0;
    logging::LogSettings log = robot::log_settings("biopsy-ros2", level, format);
    log.file = live::own_folder(options.run_folder) / "ros2.log";
    const logging::LogSession session(log);
    serve(options);
    return 0;
  });
}
