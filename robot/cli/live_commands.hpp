// The part of the command line that deals with the live robot: its processes, keys, log and hardware.
#pragma once

#include <CLI/CLI.hpp>

#include "robot/cli/live_options.hpp"

namespace biopsy::robot {

// What a procedure is given, and how the processes of a live robot find each other: each used by two
// commands.
void case_options(CLI::App& command, ProcedureOptions& options);
void procedure_options(CLI::App& command, ProcedureOptions& options);  // the same and --out
void live_options(CLI::App& command, LiveOptions& options);

struct DryRunOptions {
  ProcedureOptions procedure;
  bool live = false;
  LiveOptions network;
};

// What is typed; lives as long as the parsing.
struct LiveCommandOptions {
  UpOptions up;
  KeysOptions keys;
  LogOptions log;
  CommissionOptions commission;
};

void add_live_commands(CLI::App& app, LiveCommandOptions& options, int& code);

}  // namespace biopsy::robot
