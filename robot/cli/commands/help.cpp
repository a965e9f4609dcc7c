// biopsy help and biopsy completion: what the registry knows, for people, the reference and the shell.
#include "robot/cli/help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/text/closest_names.hpp"

namespace biopsy::robot {
namespace help_cli {

struct Options {
  std::vector<std::string> command;
  bool markdown = false;
};

void declare(CLI::App& app, Options& options) {
  CLI::Option* command = add(app, "COMMAND", options.command, "one command", "all");
  app.add_flag("--markdown", options.markdown, "print the commands' section of docs/reference/commands.md")
      ->excludes(command);
}

Result run(const Options& options, const Context&) {
  const CommandLine line;
  const std::string name = fmt::format("{}", fmt::join(options.command, " "));
  std::vector<std::string> known;
  for (const CommandLine::Entry& entry : line.entries) known.push_back(entry.command->name);
  if (!name.empty() && std::find(known.begin(), known.end(), name) == known.end())
    throw ConfigError(
        fmt::format("there is no command `{}`", name), "biopsy help",
        fmt::format("close: {}; `biopsy help` lists all", fmt::join(closest_names(name, known), ", ")));
  return {.text = options.markdown ? reference_markdown(line) : help_of(line, name),
          .json = registry_json(line)};
}

struct NoOptions {};

void declare_nothing(CLI::App&, NoOptions&) {}

Result print_completion(const NoOptions&, const Context&) {
  return {.text = bash_completion(CommandLine())};
}

}  // namespace help_cli

Command help_command() {
  using namespace help_cli;
  return {.name = "help",
          .summary = "what the program can do",
          .examples = {"biopsy help gap"},
          .exit_codes = "0, or 2 for an unknown command",
          .json =
              "a list of all commands with `name`, `summary`, `options`, `outputs`, `examples`, "
              "`exit_codes`; of an option `name`, `value`, `meaning`, `required`; of an output `name`, "
              "`content`",
          .declare = with_options(declare, run)};
}

Command completion_group() {
  using namespace help_cli;
  return {.name = "completion", .summary = "completion of commands and options in a shell"};
}

Command completion_bash_command() {
  using namespace help_cli;
  return {.name = "completion bash",
          .summary = "print the script for bash",
          .description =
              "An installation puts it into `share/bash-completion/completions`. By hand: "
              "`eval \"$(biopsy completion bash)\"` in `~/.bashrc`.",
          .examples = {"biopsy completion bash"},
          .exit_codes = "0",
          .declare = with_options(declare_nothing, print_completion)};
}

}  // namespace biopsy::robot
