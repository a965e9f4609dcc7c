// Starts the processes of the live robot and brings them down, in the order that is safe.
#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robot/msg/messages.hpp"

namespace biopsy::robot {

// Interlock and log first, so that nothing happens unguarded or unwritten.
inline constexpr std::array kStartOrder{Process::Interlock, Process::Recorder, Process::Supervisor,
                                        Process::Stage, Process::Controller};
// The supervisor first: without its permits the gate is at 0 V within 5 ms, and nobody is left to take the
// others' silence for a fault. A console goes before it: it lets the needle back gently.
inline constexpr std::array kStopOrder{Process::Person, Process::Supervisor, Process::Controller,
                                       Process::Stage,  Process::Recorder,   Process::Interlock};

class Launcher {
 public:
  // `run_folder` holds live.json; what processes print goes to NAME.txt in it.
  Launcher(std::filesystem::path run_folder, std::filesystem::path lines_folder);
  ~Launcher();  // brings down what still runs
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  // Throws ConfigError where a program is missing.
  void start();
  // `more`: what the program is told beside its folder.
  void start(Process process, const std::vector<std::string>& more = {});
  // SIGTERM to each in turn, waited for; who does not end within two seconds is killed. What happened to
  // those that did not end well, a line each.
  std::vector<std::string> stop();

  // -1: not running.
  pid_t pid_of(Process process) const { return pids_[static_cast<std::size_t>(process)]; }
  // A process that ended by itself since the last call, with what it said last.
  std::optional<std::string> ended();
  // The same of one process.
  std::optional<std::string> ended(Process process);

 private:
  std::string last_words(Process process) const;
  bool wait_for(Process process, std::chrono::milliseconds patience, int& status);

  std::filesystem::path run_folder_, lines_folder_, programs_;
  std::array<pid_t, kCount<Process>> pids_;
};

}  // namespace biopsy::robot
