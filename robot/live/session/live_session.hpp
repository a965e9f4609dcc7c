// A live robot, from its run folder to the last process: shared by `up` and `dry-run --live`.
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
#include "robot/procedure/case/prepared_case.hpp"

namespace biopsy::robot {

// Writes `folder`/live.json, creates the simulated digital I/O, and keys for a rehearsal without any. Throws
// ConfigError.
live::LiveSettings write_run_folder(const LiveOptions& options, const std::string& device,
                                    const HardwareOptions& hardware, const PreparedCase& prepared,
                                    const std::filesystem::path& folder);

// Where the operator is: only one participant may send operator acts.
enum class Person { Here, AtTheConsole };

class LiveSession {
 public:
  // Writes the run folder and starts all processes. Throws ConfigError.
  LiveSession(const LiveOptions& options, const std::string& device, const HardwareOptions& hardware,
              const PreparedCase& prepared, const std::filesystem::path& folder,
              Person person = Person::Here);
  ~LiveSession();

  // Waits until every process reports the same configuration. Throws ConfigError naming those that do not.
  void wait_until_healthy();
  // Confirmed twice, as displayed.
  void send_plan(const Plan& plan);

  LiveRobot& robot() { return *robot_; }  // of an operator here
  Launcher& launcher() { return launcher_; }
  const live::LiveSettings& settings() const { return settings_; }
  const transport::Participant& bus() const { return *bus_; }

  // Stops all in order; a line for each process that did not end with code 0.
  std::vector<std::string> stop();

 private:
  std::filesystem::path folder_;
  live::LiveSettings settings_;
  std::uint64_t config_tag_ = 0;
  Launcher launcher_;
  std::unique_ptr<transport::Participant> bus_;
  std::unique_ptr<LiveRobot> robot_;
  std::optional<transport::Writer<PlanConfirmation>> confirmations_;
};

}  // namespace biopsy::robot
