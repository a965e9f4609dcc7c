// Help texts, the reference and the shell completion, all from the registry.
#pragma once

#include <string>
#include <vector>

#include "robot/cli/command_line.hpp"

namespace biopsy::robot {

struct OptionFacts {
  std::string name;     // "--model", or "DATASET" of an argument
  std::string value;    // "FILE"; empty for a flag and an argument
  std::string meaning;  // with range, default and what it needs
  bool required = false;
};

// Of this command alone: without --help and the options of every command.
std::vector<OptionFacts> options_of(const CLI::App& app);

// Of the command that was typed; of the program where there was none.
std::string help_of(const CommandLine& line);
std::string help_of(const CommandLine& line, const std::string& command);

// The section "Commands" of docs/reference/commands.md.
std::string reference_markdown(const CommandLine& line);
// Name, summary, options, examples and outputs of every command.
std::string registry_json(const CommandLine& line);

// For bash 4.4 and later.
std::string bash_completion(const CommandLine& line);

}  // namespace biopsy::robot
