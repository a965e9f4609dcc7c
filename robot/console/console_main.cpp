// biopsy-console RUN_FOLDER: the clinician's page, for a robot that `biopsy up --console` brought up.
#include <fmt/chrono.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "robot/console/console_loop.hpp"
#include "robot/cli/live_commands.hpp"
#include "robot/procedure/procedure.hpp"
#include "robot/live/live_process.hpp"
#include "robot/live/monotonic_session_id.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/whole_file.hpp"

namespace {

using namespace biopsy;
namespace fs = std::filesystem;

struct Options {
  app::ProcedureOptions procedure;
  fs::path run_folder, page = BIOPSY_CONSOLE_PAGE;
  std::uint16_t port = 0;
};

void serve(const Options& options) {
  realtime::StopSignals signals;
  const fs::path folder = fs::absolute(options.run_folder);
  const live::LiveSettings settings = live::read_settings(folder);
  const bool simulated = settings.device == "sim";
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  const fs::path own = folder / "console" / fmt::format("{:%Y%m%dT%H%M%S}", fmt::gmtime(now));
  app::PreparedCase opened = app::open_case(app::case_of(options.procedure, app::Points::PickedLater), own);
  const transport::Participant bus(live::bus_settings(settings, keys::Role::Console));
  app::LiveRobot robot(bus, simulated ? settings.lines : fs::path(), live::config_tag(folder, settings));
  // Seconds since 1970 at least: a console that is started again gives out tokens above those it gave out
  // before, for nobody presses a button every second.
  const std::uint32_t first_token = live::rising_number(folder / "first_token");
  app::ConsoleLoop loop(robot, std::move(opened), {options.page, own, options.port, simulated, first_token});
  report::write_whole_file(folder / "console.url", loop.url());
  fs::permissions(folder / "console.url", fs::perms::owner_read | fs::perms::owner_write);
  fmt::print("{}\n", loop.url());
  std::fflush(stdout);
  while (!signals.came()) loop.turn();
  robot.let_back();
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App command("the clinician's page on this machine, for a robot that `biopsy up --console` brought up");
  command.add_option("RUN_FOLDER", options.run_folder, "of the robot: holds live.json")->required();
  app::case_options(command, options.procedure);
  command.add_option("--port", options.port, "of the page (default: any that is free)");
  command.add_option("--page", options.page, "folder of the built page");
  CLI11_PARSE(command, argc, argv);
  try {
    serve(options);
    return 0;
  } catch (const SetupError& error) {
    fmt::print(stderr, "error: {}\nwhere: {}\nto do: {}\n", error.what_is_wrong, error.where, error.remedy);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\nwhere: unexpected\nto do: report this with the command\n", error.what());
  }
  return 2;
}
