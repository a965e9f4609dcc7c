#include "robot/cli/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "robot/cli/help.hpp"
#include "robot/cli/library_messages.hpp"
#include "robot/cli/log_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/interrupt.hpp"
#include "robot/common/logging/log_session.hpp"
#include "robot/common/text/closest_names.hpp"

namespace biopsy::robot {
namespace {

constexpr int kInterrupted = 130;  // 128 + SIGINT, as a shell reports it

// "biopsy log show", as far as it was typed.
std::string typed_command(const CLI::App* app) {
  return app->get_parent() == nullptr ? app->get_name()
                                      : typed_command(app->get_parent()) + " " + app->get_name();
}

std::vector<std::string> subcommands_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

// Long names, with those of every command.
std::vector<std::string> option_names_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* one = &app; one != nullptr; one = one->get_parent())
    for (const CLI::Option* option : one->get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

// -1 and -.5 are numbers.
bool looks_like_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && word[1] != '.' && (word[1] < '0' || word[1] > '9');
}

// Of the command, or of every command; null where there is none.
const CLI::Option* option_of(const CLI::App& app, const std::string& name) {
  const CLI::Option* option = nullptr;
  for (const CLI::App* one = &app; one != nullptr && option == nullptr; one = one->get_parent())
    option = one->get_option_no_throw(name);
  return option;
}

// What to do instead of an unknown word: the names that are close to it, and where all are listed.
std::string suggestion(const std::string& typed, const std::vector<std::string>& known,
                       const std::string& command) {
  const std::vector<std::string> close = closest_names(typed, known);
  const std::string list = fmt::format("`{} --help` lists all", command);
  return close.empty() ? list : fmt::format("did you mean `{}`? {}", fmt::join(close, "` or `"), list);
}

// "Could not convert: --seed = 1e3": ranges were looked at before, so that the number is not a whole one.
std::string worded(const std::string& parser_message) {
  constexpr std::string_view kConversion = "Could not convert: ";
  const std::size_t value = parser_message.find(" = ");
  if (!parser_message.starts_with(kConversion) || value == std::string::npos) return parser_message;
  return fmt::format("{}: `{}` is not written as a whole number",
                     parser_message.substr(kConversion.size(), value - kConversion.size()),
                     parser_message.substr(value + 3));
}

// Explains why the parser refused `words`: an unknown command or option first, because the parser may have
// tripped over a consequence of it.
[[noreturn]] void refuse(const CLI::App& root, const std::vector<std::string>& words,
                         const std::string& parser_message) {
  const CLI::App* app = &root;
  bool is_value = false;  // of the option before it
  for (const std::string& word : words) {
    if (std::exchange(is_value, false) && !looks_like_option(word)) continue;
    if (word == "--") break;
    const std::string name = word.substr(0, word.find('='));
    if (looks_like_option(name)) {
      const CLI::Option* option = option_of(*app, name);
      if (option == nullptr)
        throw ConfigError(fmt::format("there is no option `{}`", name), typed_command(app),
                          suggestion(name, option_names_of(*app), typed_command(app)));
      is_value = name == word && option->get_items_expected_min() > 0;
    } else if (const std::vector<std::string> known = subcommands_of(*app); !known.empty()) {
      if (std::find(known.begin(), known.end(), word) == known.end())
        throw ConfigError(fmt::format("there is no command `{}`", word), typed_command(app),
                          suggestion(word, known, typed_command(app)));
      app = app->get_subcommand(word);
    }
  }
  const std::string command = typed_command(app);
  if (!app->get_subcommands({}).empty())
    throw ConfigError("a command is missing", command,
                      fmt::format("give one of: {}", fmt::join(subcommands_of(*app), ", ")));
  throw ConfigError(worded(parser_message), command,
                    fmt::format("`{} --help` explains the options", command));
}

// An option that is given with nothing in it would be taken as not given.
void refuse_empty_values(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options())
    for (const std::string& value : option->results())
      if (value.empty())
        throw ConfigError(fmt::format("{} is empty", option->get_name()), typed_command(&app),
                          "give a value, or leave the option out");
}

const CommandLine::Entry& chosen(const CommandLine& line) {
  for (const CommandLine::Entry& entry : line.entries)
    if (entry.run && entry.app->parsed()) return entry;
  throw std::logic_error("no command was parsed");
}

Result run(const CommandLine::Entry& entry, Context context) {
  if (!entry.command->interruptible) return entry.run(context);
  Interrupt interrupt;
  context.interrupted = interrupt.token();
  Result result = entry.run(context);
  if (context.interrupted.stop_requested()) result.exit_code = kInterrupted;
  return result;
}

}  // namespace

CommandLine::CommandLine()
    : app(std::make_unique<CLI::App>(
          "MRI-safe needle biopsy robot: plan, rehearse and verify a needle's depth", "biopsy")) {
  app->require_subcommand(1);
  app->fallthrough();  // its own options stand before or behind the command
  log_options(*app, log_level, log_format);
  for (const Command& command : registry()) {
    const std::size_t space = command.name.find(' ');
    CLI::App* parent =
        space == std::string::npos ? app.get() : app->get_subcommand(command.name.substr(0, space));
    CLI::App* added = parent->add_subcommand(
        space == std::string::npos ? command.name : command.name.substr(space + 1), command.summary);
    if (!command.declare) added->require_subcommand(1);
    entries.push_back({&command, added, command.declare ? command.declare(*added) : Run()});
    if (!command.json.empty()) added->add_flag("--json", json, "print the result as JSON on standard output");
  }
}

int run_command_line(int argc, const char* const* argv, const std::string& version) {
  CommandLine line;
  bool print_version = false;
  line.app->add_flag("--version", print_version, "version, commit and libraries");
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() == 1 && words.front() == "--version") {
    fmt::print("{}", version);
    return 0;
  }
  try {
    line.app->parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", help_of(line));
    return 0;
  } catch (const CLI::ParseError& error) {
    refuse(*line.app, words, error.what());
  }
  const CommandLine::Entry& entry = chosen(line);
  refuse_empty_values(*entry.app);
  const logging::LogSession log(log_settings("biopsy", line.log_level, line.log_format));
  log_library_messages();
  const Result result = run(entry, {.json = line.json, .interrupted = {}, .clearable = clearable_outputs()});
  fmt::print("{}", line.json ? result.json : result.text);
  return result.exit_code;
}

}  // namespace biopsy::robot
