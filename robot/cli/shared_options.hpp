// Options that several commands have in common.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "robot/cli/command_parsing.hpp"
#include "robot/live/session/live_options.hpp"
#include "robot/procedure/procedure_options.hpp"

namespace biopsy::robot {

// `words`: "--window SECONDS", an option with a value, or "DATASET", an argument. `default_text`: what holds
// without it, for the help; `value` itself must hold that already.
template <class T>
CLI::Option* add(CLI::App& app, const std::string& words, T& value, const std::string& meaning,
                 const std::string& default_text = {}) {
  const std::size_t blank = words.find(' ');
  CLI::Option* option = app.add_option(words.substr(0, blank), value, meaning)->default_str(default_text);
  return blank == std::string::npos ? option : option->type_name(words.substr(blank + 1));
}

// --out FOLDER and, where it is not required, no files without it.
CLI::Option* add_out(CLI::App& app, std::filesystem::path& out, const std::string& content);

CLI::Option* add_model(CLI::App& app, std::filesystem::path& model, const std::string& meaning,
                       const std::string& default_file = {});

// --seed N. `seed`: std::uint64_t or an optional one. Above 2^53 a program that reads the report as JSON
// would not get the same number back.
inline constexpr double kSeedMax = 9e15;
template <class Seed>
CLI::Option* add_seed(CLI::App& app, Seed& seed, const std::string& of) {
  return add(app, "--seed N", seed, "seed of " + of + "; the same seed gives the same result", "1")
      ->check(in_range(0.0, kSeedMax));
}

// What a procedure is given: a case, or an image with entry and target.
void add_case_options(CLI::App& app, ProcedureOptions& options);
// The same and --out.
void add_procedure_options(CLI::App& app, ProcedureOptions& options);

// Where a live procedure's confirmation images come from. `where`: an option without which it has no
// operator, or null.
void add_image_source(CLI::App& app, ProcedureOptions& options, CLI::Option* where);

// How the processes of a live robot find and trust each other. `live`: an option without which none of these
// has a meaning, or null.
void add_live_options(CLI::App& app, LiveOptions& options, CLI::Option* live);

void add_device(CLI::App& app, std::string& device);
// --device, --device-config and --commissioning: the last two belong to a real stage.
void add_device_options(CLI::App& app, std::string& device, HardwareOptions& hardware);
// Throws ConfigError where they do not fit together.
void check_device_options(const std::string& device, const HardwareOptions& hardware);

}  // namespace biopsy::robot
