#include "robot/cli/command_parsing.hpp"

#include <fmt/format.h>

#include "robot/common/config_error.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy::robot {

CLI::Validator in_range(double low, double high, const std::string& unit) {
  std::string range = fmt::format("{:.10g} to {:.10g}{}{}", low, high, unit.empty() ? "" : " ", unit);
  std::erase(range, '+');  // 9e+15
  return CLI::Validator(
      [low, high, range](std::string& typed) {
        const auto value = strict_number(typed);
        return value && *value >= low && *value <= high
                   ? std::string()
                   : fmt::format("`{}` is not a number in the range {}", typed, range);
      },
      range);
}

bool parse_arguments(CLI::App& command, const std::string& program, int argc, char** argv) {
  try {
    command.parse(argc, argv);
    return true;
  } catch (const CLI::CallForHelp& help) {
    command.exit(help);
    return false;
  } catch (const CLI::ParseError& error) {
    throw ConfigError(error.what(), program, fmt::format("`{} --help` explains the options", program));
  }
}

}  // namespace biopsy::robot
