// biopsy-console RUN_FOLDER: the operator's console page, for a robot that `biopsy up --console` brought up.
#include <fmt/chrono.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "drivers/needle_stage_factory.hpp"
#include "robot/cli/library_messages.hpp"
#include "robot/cli/log_options.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/logging/program.hpp"
#include "robot/console/console_loop.hpp"
#include "robot/console/server/origin_policy.hpp"
#include "robot/live/live_process.hpp"
#include "robot/live/monotonic_session_id.hpp"
#include "robot/procedure/procedure.hpp"

namespace {

using namespace biopsy;
namespace fs = std::filesystem;

struct Options {
  robot::ProcedureOptions procedure;
  fs::path run_folder, page;
  std::uint16_t port = 0;
};

void serve(const Options& options) {
  realtime::StopSignals signals;
  const fs::path page = options.page.empty() ? page_folder() : options.page;
  const fs::path folder = fs::absolute(options.run_folder);
  const live::LiveSettings settings = live::read_settings(folder);
  const bool simulated = drivers::is_simulated(settings.device);
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  const fs::path kept = live::own_folder(folder);
  const fs::path own = kept / "console" / fmt::format("{:%Y%m%dT%H%M%S}", fmt::gmtime(now));
  robot::PreparedCase opened =
      robot::open_case(robot::case_of(options.procedure, robot::Points::PickedLater), own);
  const transport::Participant bus(live::bus_settings(settings, security::Role::Console));
  robot::LiveRobot robot(bus, simulated ? settings.lines : fs::path(), live::config_tag(folder, settings));
  // Starts at the seconds since 1970 at least, so that tokens rise from one start of the console to the next.
  const std::uint32_t first_token = live::monotonic_session_id(kept / "first_token");
  // Started again for the same robot it keeps the address, so that pages that were open find it.
  const fs::path address_file = kept / "console.url";
  const auto before = console::address_of(read_file_if_present(address_file));
  const bool again = before && (options.port == 0 || options.port == before->port);
  robot::NavigationLink navigation(bus);
  robot::ConsoleLoop loop(robot, navigation, std::move(opened),
                          {page, own, again ? before->port : options.port, simulated, first_token,
                           again ? before->token : std::string()});
  atomic_write(address_file, loop.url());
  fs::permissions(address_file, fs::perms::owner_read | fs::perms::owner_write);
  fmt::print("{}\n", loop.url());
  std::fflush(stdout);
  while (!signals.came()) loop.step();
  robot.retract();
}

// False after --help.
bool parse(CLI::App& command, int argc, char** argv) {
  try {
    command.parse(argc, argv);
    return true;
  } catch (const CLI::CallForHelp& help) {
    command.exit(help);
    return false;
  } catch (const CLI::ParseError& error) {
    throw ConfigError(error.what(), "biopsy-console", "`biopsy-console --help` explains the options");
  }
}

}  // namespace

int main(int argc, char** argv) {
  return logging::run_program("biopsy-console", [&] {
    Options options;
    CLI::App command(
        "the operator's console page on this machine, for a robot that `biopsy up --console` brought up");
    command.add_option("RUN_FOLDER", options.run_folder, "of the robot: holds live.json")->required();
    robot::add_case_options(command, options.procedure);
    robot::add_image_source(command, options.procedure, nullptr);
    command.add_option("--port", options.port, "of the page (default: any that is free)")
        ->check(robot::in_range(0, 65535));
    command.add_option("--page", options.page, "folder of the built page (default: the installed one)");
    std::string level, format;
    robot::log_options(command, level, format);
    if (!parse(command, argc, argv)) return 0;
    options.procedure.real_time = true;
    logging::LogSettings log = robot::log_settings("biopsy-console", level, format);
    log.file = live::own_folder(options.run_folder) / "console.log";
    const logging::LogSession session(log);
    robot::log_library_messages();
    serve(options);
    return 0;
  });
}
