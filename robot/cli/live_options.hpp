// What the commands around the live robot are given, one function a command. Exit codes as in commands.hpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "robot/cli/commands.hpp"
#include "robot/live/session/live_options.hpp"

namespace biopsy::robot {

struct UpOptions {
  ProcedureOptions procedure;
  LiveOptions live;
  std::string device = "sim";  // or "nidaqmx"
  HardwareOptions hardware;
  bool prepare = false;    // write the run folder, start nothing
  double seconds = 0.0;    // 0: until Ctrl-C
  bool console = false;    // the person sits at the operator's console page
  bool open = false;       // and that page is opened in the desktop's browser
  std::uint16_t port = 0;  // of that page; 0: any that is free
};

// Starts every process and shows how it is, until it is told to stop. Exit code 3: one of them ended by
// itself.
int up(const UpOptions& options);

// dry-run with the real processes instead of one lockstep.
int dry_run_live(const ProcedureOptions& options, const LiveOptions& live);

struct KeysOptions {
  std::filesystem::path folder;  // empty: the one `up` uses
  int days = 365;                // that certificates are good for
  bool replace = false;          // an existing set is moved aside, not overwritten
};

// Makes, or looks through, the identities and permissions of every process.
int keys_init(const KeysOptions& options);
int keys_check(const KeysOptions& options);

struct LogOptions {
  std::filesystem::path log;         // the SQLite file
  std::filesystem::path public_key;  // empty: the one beside the log
  std::filesystem::path csv;         // export only
  int last = 0;                      // show only: this many records from the end; 0: all
  bool json = false;                 // verify only: for programs
};

int log_show(const LogOptions& options);
// Exit code 0: intact; 1: not, and what is wrong with it.
int log_verify(const LogOptions& options);
int log_export(const LogOptions& options);

struct CommissionOptions {
  std::string device = "sim";    // or "nidaqmx"
  std::filesystem::path config;  // channels and scales of the hardware (TOML)
  std::filesystem::path key;     // private key that signs the record; empty: the one of `keys init`
  std::filesystem::path out;     // folder for commissioning.json and its signature
  bool dry_run = false;          // says what would be done
  bool yes = false;  // answers every question of a step with yes: for rehearsals, simulated stage only
};

int commission(const CommissionOptions& options);

}  // namespace biopsy::robot
