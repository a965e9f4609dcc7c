// The command line: words in, one command out.
#pragma once

namespace biopsy::robot {

// Parses, runs the command and returns its exit code. Throws ConfigError for bad input.
int run_command_line(int argc, const char* const* argv);

}  // namespace biopsy::robot
