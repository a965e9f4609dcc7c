// The command line: parses it and runs one command of the registry.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <string>

#include "robot/cli/command.hpp"

namespace biopsy::robot {

// The registry with its options declared.
struct CommandLine {
  CommandLine();

  std::unique_ptr<CLI::App> app;
  struct Entry {
    const Command* command;
    CLI::App* app;
    Run run;  // empty for a group
  };
  std::vector<Entry> entries;  // in the order of the registry
  bool json = false;
  std::string log_level, log_format;  // options of every command
};

// Parses, runs the command, prints its result and returns its exit code. `version`: what --version prints.
// Throws ConfigError for bad input.
int run_command_line(int argc, const char* const* argv, const std::string& version);

}  // namespace biopsy::robot
