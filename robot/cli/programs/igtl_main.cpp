// biopsy-igtl RUN_FOLDER: OpenIGTLink for navigation programs such as 3D Slicer, for a robot that `biopsy up
// --console` brought up.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>

#include "robot/cli/log_options.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/logging/logger.hpp"
#include "robot/common/logging/program.hpp"
#include "robot/igtl/bus_robot.hpp"
#include "robot/live/live_process.hpp"
#include "robot/live/realtime/become_realtime.hpp"

namespace {

using namespace biopsy;
namespace fs = std::filesystem;

constexpr logging::Logger kLog{logging::Component::Navigation};
constexpr std::chrono::milliseconds kTurn{5};

const std::map<std::string, igtl::Dialect> kDialects{{"2013", igtl::Dialect::Of2013},
                                                     {"2021", igtl::Dialect::Of2021}};

struct Options {
  fs::path run_folder, images_to;
  std::string dialect = "2013";
  igtl::ServerSettings server;
};

void serve(const Options& options) {
  realtime::StopSignals signals;
  const fs::path folder = fs::absolute(options.run_folder);
  const live::LiveSettings settings = live::read_settings(folder);
  realtime::run_in_background();
  const transport::Participant bus(live::bus_settings(settings, security::Role::Navigation));
  igtl::BusRobot robot(bus, live::config_tag(folder, settings));
  igtl::NavigationServer server(options.server, kDialects.at(options.dialect), options.images_to, robot);
  const std::string where = fmt::format("OpenIGTLink robot, dialect {}: {}:{}", options.dialect,
                                        options.server.address, server.port());
  kLog.info("{}", where);
  fmt::print("{}\n", where);
  std::fflush(stdout);
  while (!signals.came()) server.turn(kTurn);
}

}  // namespace

int main(int argc, char** argv) {
  return logging::run_program("biopsy-igtl", [&] {
    Options options;
    CLI::App command(
        "OpenIGTLink for navigation programs such as 3D Slicer, for a robot that `biopsy up --console` "
        "brought up");
    command.add_option("RUN_FOLDER", options.run_folder, "of the robot: holds live.json")->required();
    command.add_option("--dialect", options.dialect, "order of the messages: 2013 (default) or 2021")
        ->check(CLI::IsMember({"2013", "2021"}));
    command.add_option("--port", options.server.port, "to listen at (default: 18944); 0: any that is free")
        ->check(robot::in_range(0, 65535));
    command.add_option("--listen", options.server.address,
                       "address of an interface (default: 127.0.0.1, this machine only; 0.0.0.0: all)");
    command.add_option("--images-to", options.images_to,
                       "folder into which IMAGE messages are written, as NRRD (default: they are refused)");
    std::string level, format;
    robot::log_options(command, level, format);
    if (!robot::parse_arguments(command, "biopsy-igtl", argc, argv)) return 0;
    logging::LogSettings log = robot::log_settings("biopsy-igtl", level, format);
    log.file = live::own_folder(options.run_folder) / "igtl.log";
    const logging::LogSession session(log);
    serve(options);
    return 0;
  });
}
