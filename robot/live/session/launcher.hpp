// Starts and stops the processes of the live robot in a safe order.
#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "robot/msg/messages.hpp"

namespace biopsy::robot {

// Interlock and log first, so that nothing happens without them.
inline constexpr std::array kStartOrder{Process::Interlock, Process::Recorder, Process::Supervisor,
                                        Process::Stage, Process::Controller};
// The supervisor before the rest: without its permits the gate is at 0 V within 5 ms, and the others' silence
// is no longer a fault. A console before it: it retracts the needle first.
inline constexpr std::array kStopOrder{Process::Navigation, Process::Person, Process::Supervisor,
                                       Process::Controller, Process::Stage,  Process::Recorder,
                                       Process::Interlock};

class Launcher {
 public:
  // `run_folder` holds live.json; what processes print goes to NAME.txt in it.
  Launcher(std::filesystem::path run_folder, std::filesystem::path lines_folder);
  ~Launcher();  // stops what still runs
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  // Throws ConfigError where a program is missing.
  void start();
  // `more`: further arguments.
  void start(Process process, const std::vector<std::string>& more = {});
  // A program beside the robot's processes that only looks on, such as "biopsy-ros2"; stopped before them.
  // Throws ConfigError where it is missing.
  void start_observer(const std::string& program, const std::vector<std::string>& more);
  // SIGTERM to each in turn; one that does not end within two seconds is killed. Returns a line for each that
  // did not end with code 0.
  std::vector<std::string> stop();

  // -1: not running.
  pid_t pid_of(Process process) const { return pids_[static_cast<std::size_t>(process)]; }
  // A process that ended by itself since the last call, with its last output.
  std::optional<std::string> ended();
  // The same of one process.
  std::optional<std::string> ended(Process process);
  std::optional<std::string> observer_ended();

 private:
  pid_t spawn(const std::string& program, std::vector<std::string> words,
              const std::filesystem::path& output) const;

  std::filesystem::path run_folder_, lines_folder_, programs_;
  std::array<pid_t, kCount<Process>> pids_;
  std::map<std::string, pid_t> observers_;  // by program
};

}  // namespace biopsy::robot
