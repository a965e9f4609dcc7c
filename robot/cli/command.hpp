// A command of the program: name, help, options, what it runs and which files it writes, in one place.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

namespace biopsy::robot {

struct Context {
  bool json = false;                 // the result goes to standard output as JSON, and nothing else does
  std::stop_token interrupted = {};  // Ctrl-C in an interruptible command: end with what is known so far
  std::vector<std::string> clearable = {};  // files of an earlier run that a new run in its folder replaces

  // Prints a line while the command runs; on standard error where standard output is for JSON.
  void say(const std::string& line) const;
};

struct Result {
  int exit_code = 0;
  std::string text = {};  // for people
  std::string json = {};  // for programs, printed instead with --json
};

using Run = std::function<Result(const Context&)>;

struct OutputFile {
  std::string name = {};  // one * stands for any text
  std::string content = {};
  bool kept = false;  // by a later run in the same folder
};

struct Command {
  std::string name = {};         // "gap"; "log show" is a part of the group "log", which has no `declare`
  std::string summary = {};      // one line
  std::string description = {};  // paragraphs, as Markdown
  std::vector<std::string> examples = {};       // each is run by a test, in the order of the registry
  std::vector<std::string> long_examples = {};  // they need minutes, hardware or the reader's own data
  std::string exit_codes = {};
  std::vector<OutputFile> outputs = {};
  bool replaces_earlier_run = false;  // clears the outputs of any command from its folder, and nothing else
  std::string json = {};              // what --json prints; empty: the command has no --json
  bool interruptible = false;
  std::function<Run(CLI::App&)> declare = {};  // declares the options; throws ConfigError when it runs
};

// `run` is given what the options of `declare` were set to.
template <class Options>
std::function<Run(CLI::App&)> with_options(void (*declare)(CLI::App&, Options&),
                                           Result (*run)(const Options&, const Context&)) {
  return [declare, run](CLI::App& app) -> Run {
    const auto options = std::make_shared<Options>();
    declare(app, *options);
    return [options, run](const Context& context) { return run(*options, context); };
  };
}

// Every command, in the order of the help.
const std::vector<Command>& registry();

// All outputs of commands that replace an earlier run.
std::vector<std::string> clearable_outputs();

}  // namespace biopsy::robot
