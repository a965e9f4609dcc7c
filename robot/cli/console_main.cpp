// biopsy-console RUN_FOLDER: the operator's console page, for a robot that `biopsy up --console` brought up.
// biopsy-console --review FOLDER [FOLDER2]: the page that shows finished runs; no robot, no bus.
#include <fmt/chrono.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <thread>
#include <vector>

#include "drivers/needle_stage_factory.hpp"
#include "robot/cli/library_messages.hpp"
#include "robot/cli/log_options.hpp"
#include "robot/cli/open_in_browser.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/logging/program.hpp"
#include "robot/console/console_loop.hpp"
#include "robot/console/review/finished_run.hpp"
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
  std::vector<fs::path> review;
  std::uint16_t port = 0;
  bool open = false;
};

fs::path page_of(const Options& options) {
  return options.page.empty() ? page_folder() : options.page;
}

void announce(const std::string& url) {
  fmt::print("{}\n", url);
  std::fflush(stdout);
}

void serve(const Options& options) {
  realtime::StopSignals signals;
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
                          {page_of(options), own, again ? before->port : options.port, simulated, first_token,
                           again ? before->token : std::string(), kept / "console"});
  atomic_write(address_file, loop.url());
  fs::permissions(address_file, fs::perms::owner_read | fs::perms::owner_write);
  announce(loop.url());
  while (!signals.came()) loop.step();
  robot.retract();
}

// Until Ctrl-C. All is read before the page is served.
void review(const Options& options) {
  realtime::StopSignals signals;
  const auto documents = console::review_documents(options.review);
  console::ServerCallbacks callbacks;
  callbacks.document = [&documents](const std::string& path) -> std::optional<console::Document> {
    const auto found = documents.find(path);
    if (found == documents.end()) return std::nullopt;
    return found->second;
  };
  const console::HttpServer server(page_of(options), options.port, console::new_token(), callbacks,
                                   "review.html");
  announce(server.url());
  if (options.open) robot::open_in_browser(server.url());
  while (!signals.came()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

}  // namespace

int main(int argc, char** argv) {
  return logging::run_program("biopsy-console", [&] {
    Options options;
    CLI::App command(
        "the operator's console page on this machine, for a robot that `biopsy up --console` brought up");
    CLI::Option* robot =
        command.add_option("RUN_FOLDER", options.run_folder, "of the robot: holds live.json");
    CLI::Option* review_option =
        command
            .add_option("--review", options.review,
                        "show the finished run of this folder, or two beside each other, instead of a robot")
            ->type_name("FOLDER [FOLDER2]")
            ->expected(1, console::kReviewedRunsMax)
            ->excludes(robot);
    command.add_flag("--open", options.open, "open the page of --review in the desktop's browser")
        ->needs(review_option);
    robot::add_case_options(command, options.procedure);
    robot::add_image_source(command, options.procedure, nullptr);
    command.add_option("--port", options.port, "of the page (default: any that is free)")
        ->check(robot::in_range(0, 65535));
    command.add_option("--page", options.page, "folder of the built page (default: the installed one)");
    std::string level, format;
    robot::log_options(command, level, format);
    if (!robot::parse_arguments(command, "biopsy-console", argc, argv)) return 0;
    const bool reviews = !options.review.empty();
    if (!reviews && options.run_folder.empty())
      throw ConfigError("neither a robot nor a finished run is named", "biopsy-console",
                        "give RUN_FOLDER of a robot, or --review FOLDER");
    options.procedure.real_time = true;
    logging::LogSettings log = robot::log_settings("biopsy-console", level, format);
    if (!reviews)
      log.file = live::own_folder(options.run_folder) / "console.log";  // what has ended is not written to
    const logging::LogSession session(log);
    robot::log_library_messages();
    reviews ? review(options) : serve(options);
    return 0;
  });
}
