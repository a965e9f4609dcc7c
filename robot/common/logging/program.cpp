#include "robot/common/logging/program.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "robot/common/config_error.hpp"

namespace biopsy::logging {
namespace {

void print_error(const std::string& what, const std::string& where, const std::string& remedy) {
  fmt::print(stderr, "error: {}\nwhere: {}\nto do: {}\n", what, where, remedy);
}

}  // namespace

int run_program(const std::string& name, const std::function<int()>& program) {
  try {
    return program();
  } catch (const ConfigError& error) {
    print_error(error.what_is_wrong, error.where, error.remedy);
  } catch (const std::exception& error) {
    print_error(error.what(), name, "report this with what led to it");
  }
  return 2;
}

ProgramArguments parse_arguments(const std::string& name, int argc, char** argv) {
  const std::string usage = name + " FOLDER [--log-level LEVEL] [--log-format text|json] [--log-file FILE]";
  ProgramArguments arguments{{}, settings_from_environment(name)};
  for (int n = 1; n < argc; ++n) {
    const std::string word = argv[n];
    const bool is_option = word.starts_with("--");
    if (is_option ? n + 1 == argc : !arguments.folder.empty())
      throw ConfigError(fmt::format("\"{}\" is not understood", word), name, usage);
    if (word == "--log-level")
      arguments.log.level = level_of(argv[++n], word);
    else if (word == "--log-format")
      arguments.log.format = format_of(argv[++n], word);
    else if (word == "--log-file")
      arguments.log.file = argv[++n];
    else if (is_option)
      throw ConfigError(fmt::format("there is no option {}", word), name, usage);
    else
      arguments.folder = word;
  }
  if (arguments.folder.empty()) throw ConfigError("a folder is missing", name, usage);
  return arguments;
}

}  // namespace biopsy::logging
