// The command line: words in, one command out.
#pragma once

namespace biopsy::app {

// Parses, runs the command and returns its exit code. Throws SetupError for bad input.
int run_command_line(int argc, const char* const* argv);

}  // namespace biopsy::app
