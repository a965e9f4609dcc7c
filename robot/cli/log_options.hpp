// --log-level and --log-format, of `biopsy` and of the console's process.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "robot/common/logging/log_session.hpp"

namespace biopsy::robot {

void log_options(CLI::App& app, std::string& level, std::string& format);

// What was given overrules the environment, and is put there: for processes that are started from here.
// Throws ConfigError.
logging::LogSettings log_settings(const std::string& program, const std::string& level,
                                  const std::string& format);

}  // namespace biopsy::robot
