#include "robot/live/session/live_session.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <system_error>
#include <thread>

#include "drivers/digital_io/shared_io.hpp"
#include "drivers/needle_stage_factory.hpp"
#include "planner/plan/seal.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/operator_name.hpp"
#include "robot/live/live_process.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "robot/recorder/log_file.hpp"
#include "robot/security/key_files.hpp"
#include "robot/security/key_set.hpp"
#include "robot/security/make_keys.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kLook{20};
constexpr std::chrono::seconds kHealthy{15};  // authentication on a secured bus takes a second or two
constexpr int kRehearsalDays = 365;
constexpr std::array kStarted{security::Role::Stage, security::Role::Controller, security::Role::Supervisor,
                              security::Role::Recorder, security::Role::Planner};

// In memory, one for each robot of a user. Anybody may write beside it: a link, or a folder of somebody else
// who could exchange the files in it, is not taken.
fs::path make_lines_folder(const LiveOptions& options) {
  fs::path folder = fmt::format("/dev/shm/biopsy-{}-{}-{}", getuid(), options.domain, 1);
  std::error_code error;
  fs::create_directory(folder, error);
  struct stat found {};
  const bool is_own =
      ::lstat(folder.c_str(), &found) == 0 && S_ISDIR(found.st_mode) && found.st_uid == ::getuid();
  if (!error && !is_own) error = std::make_error_code(std::errc::operation_not_permitted);
  if (!error) fs::permissions(folder, fs::perms::owner_all, error);
  if (error)
    throw ConfigError(fmt::format("the folder cannot be made: {}", error.message()), folder.string(),
                      "look who owns it; another --domain uses another folder");
  digital_io::create_shared_io(folder);
  return folder;
}

// A rehearsal without keys creates a set once: a later one in the same folder continues its log.
fs::path keys_for(const LiveOptions& options, const fs::path& folder, bool rehearsal) {
  if (!options.keys.empty()) return options.keys;
  if (!rehearsal) return security::default_folder();
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  if (!fs::exists(folder / "keys")) security::make_keys(folder / "keys", kRehearsalDays, now, false);
  return folder / "keys";
}

live::LiveSettings settings_for(const LiveOptions& options, const std::string& device,
                                const HardwareOptions& hardware, const PreparedCase& prepared,
                                const fs::path& folder) {
  if (!drivers::is_simulated(device) && (hardware.config.empty() || hardware.commissioning.empty()))
    throw ConfigError("a real stage without --device-config or --commissioning", "command line",
                      "give both; `biopsy commission` makes the record");
  if (options.without_security && !drivers::is_simulated(device))
    throw ConfigError("--without-security with a real stage", "command line",
                      "leave it away; `biopsy keys init` makes the keys");
  const Case& given = prepared.given;
  live::LiveSettings settings;
  settings.domain = options.domain;
  const fs::path keys = keys_for(options, folder, drivers::is_simulated(device));
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  security::check_set(keys, kStarted, now);  // before anything is started: each process checks its own again
  if (!options.without_security) settings.keys = fs::absolute(keys);
  settings.network = options.network;
  settings.device = device;
  if (!drivers::is_simulated(device)) {
    settings.device_config = fs::absolute(hardware.config);
    settings.commissioning = fs::absolute(hardware.commissioning);
    settings.commissioning_key =
        fs::absolute(security::signing_files(keys, security::Signer::Commissioning).public_key);
  }
  settings.log = recorder::kLogName;
  if (!options.separate_users) settings.log = fs::absolute(folder / settings.log);
  settings.log_key = fs::absolute(security::signing_files(keys, security::Signer::Recorder).private_key);
  settings.lines = make_lines_folder(options);
  settings.fifo_priority = options.fifo_priority;
  settings.model = fs::absolute(given.rehearsal.model);
  settings.tissues = fs::absolute(given.rehearsal.tissues);
  if (!options.faults.empty()) settings.faults = fs::absolute(options.faults);
  settings.weight_g = given.weight.value;
  settings.seed = given.seed;
  settings.layers = prepared.layers;
  return settings;
}

}  // namespace

live::LiveSettings write_run_folder(const LiveOptions& options, const std::string& device,
                                    const HardwareOptions& hardware, const PreparedCase& prepared,
                                    const fs::path& folder) {
  live::LiveSettings settings = settings_for(options, device, hardware, prepared, fs::absolute(folder));
  if (options.separate_users && !settings.commissioning_key.empty()) {
    // The stage's user reads it, and not the folder in which it lies.
    const fs::path copy = fs::absolute(folder) / settings.commissioning_key.filename();
    atomic_write(copy, read_file(settings.commissioning_key));
    settings.commissioning_key = copy;
  }
  atomic_write(live::settings_file(folder), live::to_json(settings));
  return settings;
}

LiveSession::LiveSession(const LiveOptions& options, const std::string& device,
                         const HardwareOptions& hardware, const PreparedCase& prepared,
                         const fs::path& folder, Person person)
    : folder_(fs::absolute(folder)),
      settings_(write_run_folder(options, device, hardware, prepared, folder_)),
      launcher_(folder_, settings_.lines) {
  config_tag_ = live::config_tag(folder_, settings_);
  if (person == Person::Here) {
    bus_ = std::make_unique<transport::Participant>(live::bus_settings(settings_, security::Role::Planner));
    robot_ = std::make_unique<LiveRobot>(*bus_, drivers::is_simulated(device) ? settings_.lines : fs::path(),
                                         config_tag_);
    confirmations_.emplace(*bus_);
  }
  launcher_.start();
}

LiveSession::~LiveSession() {
  stop();
}

void LiveSession::wait_until_healthy() {
  const std::int64_t until_ns = realtime::monotonic_ns() + std::chrono::nanoseconds(kHealthy).count();
  std::string missing;
  do {
    if (const auto ended = launcher_.ended())
      throw ConfigError(*ended, (folder_ / "*.txt").string(),
                        "see what it printed; correct it and start again");
    missing.clear();
    const std::array<Health, kCount<Process>> board = robot_->health();
    for (const Process process :
         {Process::Recorder, Process::Supervisor, Process::Stage, Process::Controller}) {
      const Health& health = board[static_cast<std::size_t>(process)];
      if (health.seq == 0 || health.config_tag != config_tag_)
        missing += fmt::format(" {}", name_of(process));
    }
    if (missing.empty()) return;
    std::this_thread::sleep_for(kLook);
  } while (realtime::monotonic_ns() < until_ns);
  throw ConfigError(fmt::format("not heard on the bus:{}", missing), folder_.string(),
                    "see *.txt in this folder; check keys and network interface");
}

void LiveSession::send_plan(const Plan& plan) {
  const std::uint64_t tag = planner::plan_tag(plan);
  robot_->send_plan(plan, {tag, tag});
  // A confirmation is taken only of the plan that the supervisor has.
  const std::int64_t until_ns = realtime::monotonic_ns() + std::chrono::nanoseconds(kHealthy).count();
  while (robot_->health()[static_cast<std::size_t>(Process::Supervisor)].plan_tag != tag &&
         realtime::monotonic_ns() < until_ns)
    std::this_thread::sleep_for(kLook);
  confirmations_.value().write({.seq = 1, .seal = plan.seal, .person = operator_name()});
}

std::vector<std::string> LiveSession::stop() {
  if (robot_) robot_->retract();
  std::vector<std::string> trouble = launcher_.stop();
  robot_.reset();
  std::error_code ignored;
  fs::remove_all(settings_.lines, ignored);
  return trouble;
}

}  // namespace biopsy::robot
