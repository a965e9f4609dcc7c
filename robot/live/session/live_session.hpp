// A live robot from its run folder to the last process: what `up` and `dry-run --live` share.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot/live/live_settings.hpp"
#include "robot/live/session/launcher.hpp"
#include "robot/live/session/live_options.hpp"
#include "robot/live/session/live_robot.hpp"
#include "robot/procedure/prepared_case.hpp"

namespace biopsy::robot {

// Writes `folder`/live.json, lays the electrical lines, makes keys for a rehearsal that brings none. Throws
// ConfigError.
live::LiveSettings write_run_folder(const LiveOptions& options, const std::string& device,
                                    const HardwareOptions& hardware, const PreparedCase& prepared,
                                    const std::filesystem::path& folder);

// Where the person sits who asks for motion: only one side of the bus may.
enum class Person { Here, AtTheConsole };

class LiveSession {
 public:
  // Writes the run folder and starts all processes. Throws ConfigError.
  LiveSession(const LiveOptions& options, const std::string& device, const HardwareOptions& hardware,
              const PreparedCase& prepared, const std::filesystem::path& folder,
              Person person = Person::Here);
  ~LiveSession();

  // Waits until every process is heard with the same configuration. Throws ConfigError naming who is not, and
  // why.
  void wait_until_healthy();
  // `shown`: what both confirmations were given for.
  void send_plan(const Plan& plan);

  LiveRobot& robot() { return *robot_; }  // of a person here
  Launcher& launcher() { return launcher_; }
  const live::LiveSettings& settings() const { return settings_; }
  const transport::Participant& bus() const { return *bus_; }

  // Brings all down in order; what did not end well, a line each.
  std::vector<std::string> stop();

 private:
  std::filesystem::path folder_;
  live::LiveSettings settings_;
  std::uint64_t config_tag_ = 0;
  Launcher launcher_;
  std::unique_ptr<transport::Participant> bus_;
  std::unique_ptr<LiveRobot> robot_;
};

}  // namespace biopsy::robot
