#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "robot/cli/help.hpp"

namespace biopsy::robot {
namespace {

// The values that an option accepts, where they are few: of CLI::IsMember, "{sim,nidaqmx}".
std::string choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  std::string choices = type.substr(open + 1, close - open - 1);
  std::replace(choices.begin(), choices.end(), ',', ' ');
  return choices;
}

// After an option that takes a value: its choices, or nothing, so that bash offers names of files.
// `command`: a pattern of bash.
std::string value_cases(const std::string& command, const CLI::App& app) {
  std::string cases;
  for (const CLI::Option* option : app.get_options())
    if (!option->get_positional() && option->get_items_expected_max() > 0)
      cases += fmt::format("    {}:--{}) words='{}' ;;\n", command, option->get_lnames().at(0),
                           choices_of(*option));
  return cases;
}

// What may follow a command: its parts; of a command without parts its options once a dash is typed, and else
// the choices of its argument or a name of a file.
std::string words_case(const CommandLine& line, const CommandLine::Entry& entry) {
  std::vector<std::string> parts, options{"--help"};
  std::string choices;
  for (const CommandLine::Entry& part : line.entries)
    if (part.command->name.starts_with(entry.command->name + " "))
      parts.push_back(part.command->name.substr(entry.command->name.size() + 1));
  for (const CLI::App* app : {entry.app, line.app.get()})
    for (const OptionFacts& option : options_of(*app))
      if (!option.value.empty() || app == entry.app)
        if (option.name.starts_with("-")) options.push_back(option.name);
  for (const CLI::Option* option : entry.app->get_options())
    if (option->get_positional()) choices += choices_of(*option);
  return parts.empty()
             ? fmt::format("    '{}') words='{}'; [[ $current == -* ]] && words='{}' ;;\n",
                           entry.command->name, choices, fmt::join(options, " "))
             : fmt::format("    '{}') words='{} --help' ;;\n", entry.command->name, fmt::join(parts, " "));
}

constexpr const char* kScript = R"(# bash completion of biopsy; made by: biopsy completion bash
_biopsy() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} command='' words='' i
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "${{command:+$command }}${{COMP_WORDS[i]}}" in
      {1}) command="${{command:+$command }}${{COMP_WORDS[i]}}" ;;
      *) break ;;
    esac
  done
  case "$command" in
    '') words='{0} --help --version' ;;
{2}  esac
  case "$command:$previous" in
{3}  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o default -F _biopsy biopsy
)";

}  // namespace

std::string bash_completion(const CommandLine& line) {
  std::vector<std::string> top, all;
  std::string words, values = value_cases("*", *line.app);
  for (const CommandLine::Entry& entry : line.entries) {
    all.push_back("'" + entry.command->name + "'");
    if (entry.command->name.find(' ') == std::string::npos) top.push_back(entry.command->name);
    words += words_case(line, entry);
    values += value_cases("'" + entry.command->name + "'", *entry.app);
  }
  return fmt::format(fmt::runtime(kScript), fmt::join(top, " "), fmt::join(all, " | "), words, values);
}

}  // namespace biopsy::robot
