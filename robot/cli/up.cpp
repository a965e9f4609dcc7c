// biopsy up and biopsy dry-run --live: the robot as processes.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "drivers/digital_io/io_views.hpp"
#include "robot/cli/live_options.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/logging/log_session.hpp"
#include "robot/common/logging/logger.hpp"
#include "robot/common/progress.hpp"
#include "robot/live/realtime/stop_signals.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "robot/live/session/live_session.hpp"
#include "robot/procedure/procedure.hpp"
#include "robot/procedure/rehearsal.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::robot {
namespace {

using Clock = std::chrono::steady_clock;

constexpr logging::Logger kLog{logging::Component::Cli};
constexpr const char* kLogFile = "biopsy.log";

// Nothing more to be done if the case has no plan; its report says why.
bool is_refused(const PreparedCase& prepared, const std::filesystem::path& out, Clock::time_point started) {
  if (std::holds_alternative<Plan>(prepared.plan)) return false;
  report::RunRecord refused = planned_record(prepared);
  refused.simulated_s = 0.0;
  finish(refused, prepared, out, started);
  return true;
}

void print_trouble(const std::vector<std::string>& trouble) {
  for (const std::string& line : trouble) kLog.error("{}", line);
}

// The interlock says nothing on the bus: its relay is a line that anybody may look at.
std::string relay_text(const digital_io::IoReader& lines) {
  const digital_io::RelayReading relay = lines.relay();
  const std::int64_t silent_ms = (realtime::monotonic_ns() - relay.ticked_ns) / 1'000'000;
  return silent_ms > 100       ? "interlock SILENT  "
         : relay.output.closed ? "interlock closed  "
                               : "interlock open  ";
}

std::string board_text(const std::array<Health, kCount<Process>>& board, const std::optional<CycleSample>& cycle,
                       const digital_io::IoReader& lines) {
  std::string text = relay_text(lines);
  for (const Process process :
       {Process::Recorder, Process::Supervisor, Process::Stage, Process::Controller}) {
    const Health& health = board[static_cast<std::size_t>(process)];
    text += health.seq == 0 ? fmt::format("{} SILENT  ", name_of(process))
                            : fmt::format("{} p99 {} us, missed {}  ", name_of(process), health.late_p99_us,
                                          health.overruns);
    if (!health.note.empty()) text += fmt::format("({})  ", health.note);
  }
  if (cycle)
    text +=
        fmt::format("| {}{}{} | {:.2f} mm, {:.2f} kV", safety::name_of(cycle->record.supervisor.permit.mode),
                    cycle->record.supervisor.worst == safety::Hazard::None ? "" : ": ",
                    cycle->record.supervisor.worst == safety::Hazard::None
                        ? std::string_view()
                        : safety::name_of(cycle->record.supervisor.worst),
                    cycle->record.measurement.depth_um * 1e-3, cycle->record.measurement.monitor_mV * 1e-6);
  return text;
}

}  // namespace

int dry_run_live(const ProcedureOptions& options, const LiveOptions& live_options) {
  const auto started = Clock::now();
  const Case given = case_of(options);
  claim_run_folder(options.out, files_of(given));
  logging::log_to_file(options.out / kLogFile);
  kLog.info("dry-run --live: domain {}", live_options.domain);
  ProgressLine line;
  line.show(-1.0, "reading the image and planning");
  const PreparedCase prepared = prepare(given, options.out);
  if (is_refused(prepared, options.out, started)) return 3;
  line.show(-1.0, "starting the processes");
  LiveSession session(live_options, "sim", {}, prepared, options.out);
  session.wait_until_healthy();
  session.send_plan(std::get<Plan>(prepared.plan));
  std::optional<std::string> ended;
  const Robot robot = [&](const OperatorInputs& inputs) -> std::optional<CycleSample> {
    std::optional<CycleSample> cycle = session.robot().tick(inputs);
    if (!ended) ended = session.launcher().ended();
    return cycle;
  };
  report::RunRecord record =
      rehearse_on(robot, prepared, options.out,
                  [&line](double share, const std::string& what) { line.show(share, what); });
  if (ended) record.refusal += (record.refusal.empty() ? "" : "; ") + *ended;
  const std::uint64_t lost = session.robot().lost();
  print_trouble(session.stop());
  finish(record, prepared, options.out, started);
  fmt::print("procedure log: {}\n", session.settings().log.string());
  if (lost > 0) fmt::print("{} ticks did not reach the report\n", lost);
  return record.outcome == report::Outcome::Completed ? 0 : 3;
}

namespace {

// What the console must know to plan the same case.
std::vector<std::string> console_words(const UpOptions& options) {
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
  add("--labels", given.labels.string());
  add("--fiducials", given.fiducials.string());
  add("--model", given.model.string());
  add("--seed", given.seed ? std::to_string(*given.seed) : "");
  add("--port", std::to_string(options.port));
  return words;
}

// Where there is no desktop the address is there to be typed.
void open_in_browser(const std::string& url) {
  if (fork() != 0) return;
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  execlp("xdg-open", "xdg-open", url.c_str(), nullptr);
  _exit(127);
}

// The console asks for motion, nobody here does. Where it ends by itself the robot holds the needle, then
// lets it back; the other processes go on, so that it can be started again.
int up_with_console(const UpOptions& options, const PreparedCase& prepared, realtime::StopSignals& signals) {
  LiveSession session(options.live, options.device, options.hardware, prepared, options.procedure.out,
                      Person::AtTheConsole);
  const std::filesystem::path address = options.procedure.out / "console.url";
  std::filesystem::remove(address);
  session.launcher().start(Process::Person, console_words(options));
  const auto started = Clock::now();
  std::optional<std::string> ended;
  bool told = false;
  while (!signals.came() && !ended) {
    if (!told && std::filesystem::exists(address)) {
      told = true;
      fmt::print("console: {}\nup; Ctrl-C brings it down\n", read_file(address));
      std::fflush(stdout);
      if (options.open) open_in_browser(read_file(address));
    }
    if (const auto alone = session.launcher().ended(Process::Person)) {
      if (!told) ended = alone;
      kLog.error("{}; the robot holds the needle, then retracts it; Ctrl-C stops the robot", *alone);
    }
    if (!ended) ended = session.launcher().ended();
    if (options.seconds > 0.0 && Clock::now() - started > std::chrono::duration<double>(options.seconds))
      break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  if (ended) kLog.error("{}", *ended);
  print_trouble(session.stop());
  fmt::print("\ndown; procedure log: {}\n", session.settings().log.string());
  return ended ? 3 : 0;
}

// The lines lie in memory, under a name that tells users and domains apart; a unit needs one that stays.
int prepare_only(const UpOptions& options, const PreparedCase& prepared) {
  const std::filesystem::path& folder = options.procedure.out;
  const live::LiveSettings settings =
      write_run_folder(options.live, options.device, options.hardware, prepared, folder);
  std::filesystem::remove(folder / "lines");
  std::filesystem::create_directory_symlink(settings.lines, folder / "lines");
  fmt::print("prepared: {}\nnothing was started: systemctl start biopsy.target\n", folder.string());
  return 0;
}

}  // namespace

int up(const UpOptions& options) {
  realtime::StopSignals signals;
  const auto started = Clock::now();
  const Case given = case_of(options.procedure, options.console ? Points::PickedLater : Points::Given);
  claim_run_folder(options.procedure.out, files_of(given));
  logging::log_to_file(options.procedure.out / kLogFile);
  kLog.info("up: device {}, domain {}", options.device, options.live.domain);
  const PreparedCase prepared = prepare(given, options.procedure.out);
  if (has_points(given) && is_refused(prepared, options.procedure.out, started)) return 3;
  if (options.prepare) return prepare_only(options, prepared);
  if (options.console) return up_with_console(options, prepared, signals);
  LiveSession session(options.live, options.device, options.hardware, prepared, options.procedure.out);
  session.wait_until_healthy();
  session.send_plan(std::get<Plan>(prepared.plan));
  fmt::print("up: {}; Ctrl-C brings it down\n",
             session.settings().keys.empty() ? "WITHOUT security" : "secured");
  ProgressLine line;
  std::optional<std::string> ended;
  std::optional<CycleSample> cycle;
  std::int64_t ticks = 0;
  const digital_io::IoReader lines(session.settings().lines);
  while (!signals.came() && !ended) {
    OperatorInputs nobody = OperatorInputs::idle();  // the E-stop is released, no key is turned
    cycle = session.robot().tick(nobody);
    if (ticks++ % 250 == 0) line.show(-1.0, board_text(session.robot().health(), cycle, lines));
    ended = session.launcher().ended();
    if (options.seconds > 0.0 && Clock::now() - started > std::chrono::duration<double>(options.seconds))
      break;
  }
  if (ended) kLog.error("{}", *ended);
  print_trouble(session.stop());
  fmt::print("\ndown; procedure log: {}\n", session.settings().log.string());
  return ended ? 3 : 0;
}

}  // namespace biopsy::robot
