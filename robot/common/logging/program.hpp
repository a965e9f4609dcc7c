// How programs begin and end: their folder and log options, exit codes and error lines.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "robot/common/logging/log_session.hpp"

namespace biopsy::logging {

// Runs `program` and returns its exit code. After a ConfigError or any other exception: 2, and the three
// lines "error:", "where:" and "to do:" on stderr. `name`: where other exceptions come from.
int run_program(const std::string& name, const std::function<int()>& program);

struct ProgramArguments {
  std::filesystem::path folder;
  LogSettings log;
};

// Of a process of the live robot: FOLDER [--log-level LEVEL] [--log-format FORMAT] [--log-file FILE], of
// which options overrule the environment. Throws ConfigError.
ProgramArguments parse_arguments(const std::string& name, int argc, char** argv);

}  // namespace biopsy::logging
