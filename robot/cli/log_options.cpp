#include "robot/cli/log_options.hpp"

#include <cstdlib>

namespace biopsy::robot {

void log_options(CLI::App& app, std::string& level, std::string& format) {
  app.add_option("--log-level", level,
                 "least severe [diagnostic messages](diagnostic-log.md) that are logged: trace, debug, info, "
                 "warning, error or "
                 "off")
      ->type_name("LEVEL")
      ->check(CLI::IsMember({"trace", "debug", "info", "warning", "error", "off"}))
      ->default_str("$BIOPSY_LOG_LEVEL; else warning on the terminal, info in log files");
  app.add_option("--log-format", format, "of diagnostic messages: text, or json for one object a line")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"text", "json"}))
      ->default_str("$BIOPSY_LOG_FORMAT; else text");
}

logging::LogSettings log_settings(const std::string& program, const std::string& level,
                                  const std::string& format) {
  if (!level.empty()) ::setenv(logging::kLevelVariable, level.c_str(), 1);
  if (!format.empty()) ::setenv(logging::kFormatVariable, format.c_str(), 1);
  return logging::settings_from_environment(program);
}

}  // namespace biopsy::robot
