// Arguments of every program, those of the live robot included: nothing of the robot is needed for them.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace biopsy::robot {

// A finite number within the range, in `unit`.
CLI::Validator in_range(double low, double high, const std::string& unit = {});

// Of a program beside `biopsy`. False after --help. Throws ConfigError for words that are not understood.
bool parse_arguments(CLI::App& command, const std::string& program, int argc, char** argv);

}  // namespace biopsy::robot
