// biopsy up: the robot as processes.
#include <fmt/format.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "drivers/digital_io/io_views.hpp"
#include "drivers/needle_stage_factory.hpp"
#include "robot/cli/command.hpp"
#include "robot/cli/open_in_browser.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/logging/log_session.hpp"
#include "robot/common/logging/logger.hpp"
#include "robot/common/progress.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/live/realtime/stop_signals.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "robot/live/session/live_session.hpp"
#include "robot/live/session/ownership.hpp"
#include "robot/procedure/procedure.hpp"
#include "robot/procedure/rehearsal.hpp"
#include "robot/report/procedure/report.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::robot {
namespace up_cli {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr logging::Logger kLog{logging::Component::Cli};

struct Options {
  ProcedureOptions procedure;
  LiveOptions live;
  std::string device{drivers::kStageDevices[0]};
  HardwareOptions hardware;
  bool prepare = false;    // write the run folder, start nothing
  double seconds = 0.0;    // 0: until Ctrl-C
  bool console = false;    // the operator uses the console page
  bool open = false;       // which is opened in the desktop's browser
  std::uint16_t port = 0;  // of that page; 0: any that is free
  std::string igtl;        // dialect; empty: no navigation program can connect
  std::uint16_t igtl_port = 18944;
  bool mcap = false;             // record every topic for viewers
  bool ros2 = false;             // publish the state as topics of ROS 2
  std::int32_t ros_domain = -1;  // as ROS_DOMAIN_ID says, or 0
};

void declare(CLI::App& app, Options& options) {
  add_procedure_options(app, options.procedure);
  add_device_options(app, options.device, options.hardware);
  CLI::Option* seconds =
      add(app, "--seconds S", options.seconds, "end by itself after this time; 0: on Ctrl-C", "0")
          ->check(in_range(0.0, 1e6, "s"));
  CLI::Option* prepare =
      app.add_flag("--prepare", options.prepare,
                   "write the run folder and start nothing: [an installed system](../how-to/install.md)")
          ->excludes(seconds);
  app.add_flag("--separate-users", options.live.separate_users,
               "with --prepare: give each process's files to a user of its own; needs root")
      ->needs(prepare);
  CLI::Option* console = app.add_flag("--console", options.console,
                                      "serve the operator's page, the [console](../tutorials/clinician.md)");
  app.add_flag("--open", options.open, "open that page in the desktop's browser")
      ->needs(console)
      ->excludes(prepare);
  add(app, "--port N", options.port, "port of that page; 0: any that is free", "0")
      ->check(in_range(0, 65535))
      ->needs(console)
      ->excludes(prepare);
  CLI::Option* igtl =
      add(app, "--igtl DIALECT", options.igtl,
          "let a navigation program propose targets, over [OpenIGTLink](../how-to/slicer.md): "
          "`2013` or `2021`, the order of its messages")
          ->check(CLI::IsMember({"2013", "2021"}))
          ->needs(console)
          ->excludes(prepare);
  add(app, "--igtl-port N", options.igtl_port, "port of it, on this machine only; 0: any that is free",
      "18944")
      ->check(in_range(0, 65535))
      ->needs(igtl);
  app.add_flag("--mcap", options.mcap,
               "record every topic of the bus in an [MCAP file](../how-to/use-the-log.md#record-the-bus) "
               "for viewers")
      ->excludes(prepare);
  app.add_flag("--ros2", options.ros2,
               "publish the robot's state as topics of [ROS 2](../how-to/ros2.md), on this machine")
      ->excludes(prepare);
  add(app, "--ros-domain N", options.ros_domain, "DDS domain of ROS 2, another than that of the robot",
      "`ROS_DOMAIN_ID`, or 0")
      ->check(in_range(0, 230));
  add_image_source(app, options.procedure, console);
  app.get_option("--scan")->needs(console);
  add_live_options(app, options.live, nullptr);
}

void print_trouble(const std::vector<std::string>& trouble) {
  for (const std::string& line : trouble) kLog.error("{}", line);
}

// The interlock is not on the bus: its relay is read directly.
std::string relay_text(const digital_io::IoReader& lines) {
  const digital_io::RelayReading relay = lines.relay();
  const std::int64_t silent_ms = (realtime::monotonic_ns() - relay.ticked_ns) / 1'000'000;
  return silent_ms > 100       ? "interlock SILENT  "
         : relay.output.closed ? "interlock closed  "
                               : "interlock open  ";
}

std::string board_text(const std::array<Health, kCount<Process>>& board,
                       const std::optional<CycleSample>& cycle, const digital_io::IoReader& lines) {
  std::string text = relay_text(lines);
  for (const Process process :
       {Process::Recorder, Process::Supervisor, Process::Stage, Process::Controller}) {
    const Health& health = board[static_cast<std::size_t>(process)];
    text += health.seq == 0 ? fmt::format("{} SILENT  ", name_of(process))
                            : fmt::format("{} p99 {} us, missed {}  ", name_of(process), health.late_p99_us,
                                          health.overruns);
    if (!health.note.empty()) text += fmt::format("({})  ", health.note);
  }
  if (!cycle) return text;
  const CycleRecord& tick = cycle->record;
  const safety::Hazard worst = tick.supervisor.worst;
  text += fmt::format("| {}", safety::name_of(tick.supervisor.permit.mode));
  if (worst != safety::Hazard::None) text += fmt::format(": {}", hazard_text(worst, tick.panel_unread_ms));
  text += fmt::format(" | {}, {}", fixed(tick.measurement.depth_um * 1e-3, 2, "mm"),
                      fixed(tick.measurement.monitor_mV * 1e-6, 2, "kV"));
  return text;
}

// A console that ended by itself: so often, so long afterwards.
constexpr int kRestartsMax = 5;
constexpr std::chrono::seconds kRestartAfter{2};

// What the console must know to plan the same case.
std::vector<std::string> console_arguments(const Options& options) {
  const ProcedureOptions& given = options.procedure;
  std::vector<std::string> words;
  if (!given.case_name.empty()) words.push_back(given.case_name);
  const auto add = [&words](const char* name, const std::string& value) {
    if (!value.empty()) words.push_back(fmt::format("{}={}", name, value));
  };
  add("--image", given.image.string());
  add("--series", given.series);
  add("--entry", given.entry);
  add("--target", given.target);
  add("--markups", given.markups.string());
  add("--labels", given.labels.string());
  if (given.labels_anyway) words.emplace_back("--labels-anyway");
  add("--fiducials", given.fiducials.string());
  add("--model", given.model.string());
  add("--seed", given.seed ? std::to_string(*given.seed) : "");
  add("--images-from", given.images_from.empty() ? "" : fs::absolute(given.images_from).string());
  if (!given.images_from.empty()) {
    add("--images-quiet", fmt::format("{}", given.images_quiet_s));
    add("--images-patience", fmt::format("{}", given.images_patience_s));
    add("--images-confirmed-by", given.images_confirmed_by);
    if (given.images_planes > 0) add("--images-planes", std::to_string(given.images_planes));
  }
  if (given.scan_s) add("--scan", fmt::format("{}", *given.scan_s));
  add("--port", std::to_string(options.port));
  return words;
}

std::string first_line(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

std::vector<std::string> igtl_arguments(const Options& options) {
  std::vector<std::string> words{"--dialect", options.igtl, "--port", std::to_string(options.igtl_port)};
  if (!options.procedure.images_from.empty())
    words.insert(words.end(),
                 {"--images-to", std::filesystem::absolute(options.procedure.images_from).string()});
  return words;
}

void start_observers(const Options& options, LiveSession& session) {
  if (options.mcap) session.launcher().start_observer("biopsy-mcap", {});
  std::vector<std::string> words;
  if (options.ros_domain >= 0) words = {"--ros-domain", std::to_string(options.ros_domain)};
  if (options.ros2) session.launcher().start_observer("biopsy-ros2", words);
}

// The robot goes on without them.
void watch_observers(LiveSession& session) {
  if (const auto alone = session.launcher().observer_ended())
    kLog.error("{}; the robot goes on without it", *alone);
}

// How a session came to its end.
struct Ending {
  std::optional<std::string> ended;  // a process, by itself
  std::vector<std::string> trouble;  // of bringing the others down
  std::string log;
};

Ending bring_down(LiveSession& session, std::optional<std::string> ended) {
  Ending ending{std::move(ended), session.stop(), session.settings().log.string()};
  if (ending.ended) kLog.error("{}", *ending.ended);
  print_trouble(ending.trouble);
  return ending;
}

// The console requests motion. Where it ends by itself the robot holds the needle, then retracts; the other
// processes go on, and it is started again with the same address.
Ending run_with_console(const Options& options, const PreparedCase& prepared, realtime::StopSignals& signals,
                        const Context& context) {
  LiveSession session(options.live, options.device, options.hardware, prepared, options.procedure.out,
                      Person::AtTheConsole);
  const std::filesystem::path address = options.procedure.out / "console.url";
  std::filesystem::remove(address);
  session.launcher().start(Process::Person, console_arguments(options));
  if (!options.igtl.empty()) session.launcher().start(Process::Navigation, igtl_arguments(options));
  start_observers(options, session);
  const auto started = Clock::now();
  std::optional<std::string> ended;
  bool announced = false;
  constexpr auto kNever = Clock::time_point::max();
  Clock::time_point restart_at = kNever;
  int restarts = 0;
  while (!signals.came() && !ended) {
    if (!announced && std::filesystem::exists(address)) {
      announced = true;
      context.say(fmt::format("console: {}\nup; Ctrl-C brings it down", first_line(address)));
      if (options.open) open_in_browser(first_line(address));
    }
    if (const auto alone = session.launcher().ended(Process::Person)) {
      if (!announced || restarts == kRestartsMax) ended = alone;
      kLog.error(
          "{}; the robot holds the needle, then retracts it; {}", *alone,
          ended ? "the robot is brought down" : "the console is started again, without points and plan");
      restart_at = Clock::now() + kRestartAfter;
    }
    if (const auto alone = session.launcher().ended(Process::Navigation))
      kLog.error("{}; no navigation program can connect", *alone);
    watch_observers(session);
    if (!ended && Clock::now() > restart_at) {
      restart_at = kNever;
      ++restarts;
      session.launcher().start(Process::Person, console_arguments(options));
    }
    if (!ended) ended = session.launcher().ended();
    if (options.seconds > 0.0 && Clock::now() - started > std::chrono::duration<double>(options.seconds))
      break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return bring_down(session, std::move(ended));
}

Ending run_without_console(const Options& options, const PreparedCase& prepared,
                           realtime::StopSignals& signals, const Context& context,
                           Clock::time_point started) {
  LiveSession session(options.live, options.device, options.hardware, prepared, options.procedure.out);
  session.wait_until_healthy();
  session.send_plan(std::get<Plan>(prepared.plan));
  start_observers(options, session);
  context.say(fmt::format("up: {}; Ctrl-C brings it down",
                          session.settings().keys.empty() ? "WITHOUT security" : "secured"));
  ProgressLine line;
  std::optional<std::string> ended;
  std::optional<CycleSample> cycle;
  std::int64_t ticks = 0;
  const digital_io::IoReader lines(session.settings().lines);
  while (!signals.came() && !ended) {
    const OperatorInputs idle = OperatorInputs::idle();  // the E-stop is released, no key is turned
    cycle = session.robot().tick(idle);
    if (ticks++ % 250 == 0) line.show(-1.0, board_text(session.robot().health(), cycle, lines));
    watch_observers(session);
    ended = session.launcher().ended();
    if (options.seconds > 0.0 && Clock::now() - started > std::chrono::duration<double>(options.seconds))
      break;
  }
  return bring_down(session, std::move(ended));
}

// The shared memory's name tells users and domains apart; a systemd unit needs a fixed path to it.
Result prepare_only(const Options& options, const PreparedCase& prepared) {
  const std::filesystem::path& folder = options.procedure.out;
  const live::LiveSettings settings =
      write_run_folder(options.live, options.device, options.hardware, prepared, folder);
  std::filesystem::remove(folder / "lines");
  std::filesystem::create_directory_symlink(settings.lines, folder / "lines");
  if (options.live.separate_users) give_to_owners(ownership_of(std::filesystem::absolute(folder), settings));
  return {.text = fmt::format("prepared: {}\nnothing was started: systemctl start biopsy.target\n",
                              folder.string()),
          .json = nlohmann::ordered_json{{"prepared", folder.string()}}.dump(2) + "\n"};
}

Result run(const Options& options, const Context& context) {
  realtime::StopSignals signals;
  const auto started = Clock::now();
  const bool ros_domain_known = options.ros_domain >= 0 || std::getenv("ROS_DOMAIN_ID") == nullptr;
  if (options.ros2 && ros_domain_known &&
      std::max(options.ros_domain, 0) == static_cast<int>(options.live.domain))
    throw ConfigError(fmt::format("ROS 2 and the robot would share DDS domain {}", options.live.domain),
                      "command line", "give one of them another: --domain N or --ros-domain N");
  check_device_options(options.device, options.hardware);
  if (!drivers::is_simulated(options.device) && !options.procedure.model.empty())
    throw ConfigError("--model with a real stage, which is not simulated", "command line", "leave it out");
  if (!drivers::is_simulated(options.device) && options.console && options.procedure.images_from.empty())
    throw ConfigError("a real stage with simulated confirmation images", "command line",
                      "add --images-from FOLDER, into which the scanner exports");
  if (options.console) page_folder();  // refused before anything is started
  const Case given = case_of(options.procedure, options.console ? Points::PickedLater : Points::Given);
  const PreparedCase prepared = prepare_run(given, options.procedure.out, context.clearable);
  logging::log_to_file(options.procedure.out / "biopsy.log");
  kLog.info("up: device {}, domain {}", options.device, options.live.domain);
  if (has_points(given) && std::holds_alternative<PlanRefusal>(prepared.plan)) {
    report::RunRecord refused = planned_record(prepared);
    std::string text = finish(refused, prepared, options.procedure.out, started);
    return {.exit_code = 3, .text = std::move(text), .json = report::report_json(refused)};
  }
  if (options.prepare) return prepare_only(options, prepared);
  const Ending ending = options.console ? run_with_console(options, prepared, signals, context)
                                        : run_without_console(options, prepared, signals, context, started);
  const nlohmann::ordered_json json = {
      {"ended", ending.ended ? nlohmann::ordered_json(*ending.ended) : nlohmann::ordered_json(nullptr)},
      {"trouble", ending.trouble},
      {"procedure_log", ending.log}};
  return {.exit_code = ending.ended ? 3 : 0,
          .text = fmt::format("\ndown; procedure log: {}\n", ending.log),
          .json = json.dump(2) + "\n"};
}

}  // namespace up_cli

Command up_command() {
  using namespace up_cli;
  return {.name = "up",
          .summary = "start the live robot's processes and show their state",
          .description =
              "Plans, starts interlock, recorder, supervisor, stage and controller over DDS with "
              "security, and shows their state until Ctrl-C; then brings them down in order, HV first: "
              "[the live robot](../how-to/live.md). Nothing is armed: that takes the key on the device. With "
              "`--console` an image folder is enough: series, entry and target are picked on the page.",
          .long_examples = {"biopsy up gap --seconds 5 --keys out/keys --out out/up"},
          .exit_codes = "0, 3 where a process ended by itself or the plan is refused, 2 for unusable input",
          .outputs = {{"procedure.log.sqlite",
                       "the [procedure log](procedure-log.md); a later run in the folder continues it", true},
                      {"live.json", "what every process was started with", true},
                      {"*.log", "the [diagnostic log](diagnostic-log.md) of each process", true},
                      {"console", "with `--console`: a folder for each run"},
                      {"navigation.txt", "with `--igtl`: where it listens"},
                      {"bus*.mcap", "with `--mcap`: every topic of the bus", true},
                      {"biopsy-mcap.txt", "with `--mcap`: which file that is"},
                      {"biopsy-ros2.txt", "with `--ros2`: what it publishes"},
                      {"console.url", "with `--console`: the page's address"}},
          .replaces_earlier_run = true,
          .json =
              "`ended`, the process that ended by itself, or `null`; `trouble`, a list of what did not end "
              "well; `procedure_log`. With `--prepare` `prepared`, the folder. Of a refused plan the "
              "content of [report.json](#reportjson)",
          .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
