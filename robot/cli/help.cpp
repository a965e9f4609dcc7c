#include "robot/cli/help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>

namespace biopsy::robot {
namespace {

// Of the first validator, as "0 to 230".
std::string range_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t colon = type.find(':');
  return colon == std::string::npos || type.find('{') != std::string::npos ? "" : type.substr(colon + 1);
}

std::string value_of(const CLI::Option& option) {
  if (option.get_positional() || option.get_items_expected_max() == 0) return {};
  const std::string type = option.get_type_name();
  return type.substr(0, type.find(':'));
}

std::string joined(const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options) names.push_back("`" + option->get_name() + "`");
  std::sort(names.begin(), names.end());
  return fmt::format("{}", fmt::join(names, ", "));
}

bool is_group(const CommandLine::Entry& entry) {
  return !entry.run;
}

// Markdown for a terminal: without the marks of code; a link, relative to docs/reference, becomes "text
// (docs/...)".
std::string for_terminal(const std::string& markdown) {
  static const std::regex kUp(R"(\[([^\]]+)\]\(\.\./([a-z0-9/-]+\.md)[^)]*\))"),
      kBeside(R"(\[([^\]]+)\]\(([a-z0-9-]+\.md)[^)]*\))"), kAnchor(R"(\[([^\]]+)\]\(#[^)]*\))"),
      kWeb(R"(\[([^\]]+)\]\((https://[^)]*)\))");
  std::string text = std::regex_replace(markdown, kUp, "$1 (docs/$2)");
  text = std::regex_replace(text, kBeside, "$1 (docs/reference/$2)");
  text = std::regex_replace(text, kAnchor, "$1");
  text = std::regex_replace(text, kWeb, "$1 ($2)");
  std::erase(text, '`');
  return text;
}

std::string usage(const CommandLine::Entry& entry) {
  std::string line = "biopsy " + entry.command->name;
  if (is_group(entry)) return line + " COMMAND";
  std::string optional;
  for (const OptionFacts& option : options_of(*entry.app)) {
    const std::string word = option.name + (option.value.empty() ? "" : " " + option.value);
    if (option.required)
      line += " " + word;
    else if (!option.name.starts_with("-"))
      line += " [" + word + "]";
    else
      optional = " [options]";
  }
  return line + optional;
}

// Lines of at most 100 letters, broken at blanks.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t first) {
  constexpr std::size_t kWidth = 100;
  std::string out;
  std::size_t column = first;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find_first_of(" \n", at), text.size());
    const std::string word = text.substr(at, end - at);
    if (column > indent && column + 1 + word.size() > kWidth) {
      out += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      out += ' ';
      ++column;
    }
    out += word;
    column += word.size();
    if (end < text.size() && text[end] == '\n') {
      out += "\n" + std::string(indent, ' ');
      column = indent;
    }
    at = end + 1;
  }
  return out;
}

std::string table(const std::vector<std::pair<std::string, std::string>>& rows) {
  constexpr std::size_t kMostName = 26;
  std::size_t width = 0;
  for (const auto& [name, text] : rows) width = std::max(width, std::min(name.size(), kMostName));
  std::string out;
  for (const auto& [name, text] : rows) {
    out += fmt::format("  {:<{}}", name, width);
    if (name.size() > width) out += "\n" + std::string(width + 2, ' ');
    out += "  " + wrapped(for_terminal(text), width + 4, width + 4) + "\n";
  }
  return out;
}

std::string examples_of(const Command& command) {
  std::vector<std::string> all = command.examples;
  all.insert(all.end(), command.long_examples.begin(), command.long_examples.end());
  return all.empty() ? "" : fmt::format("\nExample:\n  {}\n", fmt::join(all, "\n  "));
}

std::string help_text(const CommandLine& line, const CommandLine::Entry& entry) {
  const Command& command = *entry.command;
  std::string text = fmt::format("{}\n\n{}\n", usage(entry), command.summary);
  if (!command.description.empty()) text += "\n" + wrapped(for_terminal(command.description), 0, 0) + "\n";
  if (is_group(entry)) {
    std::vector<std::pair<std::string, std::string>> parts;
    for (const CommandLine::Entry& part : line.entries)
      if (part.command->name.starts_with(command.name + " "))
        parts.emplace_back(part.command->name, part.command->summary);
    return text + "\nCommands:\n" + table(parts);
  }
  std::vector<std::pair<std::string, std::string>> rows;
  for (const OptionFacts& option : options_of(*entry.app))
    rows.emplace_back(option.name + (option.value.empty() ? "" : " " + option.value), option.meaning);
  for (const OptionFacts& option : options_of(*line.app))
    if (!option.value.empty()) rows.emplace_back(option.name + " " + option.value, option.meaning);
  rows.emplace_back("-h, --help", "this text");
  text += "\nOptions:\n" + table(rows);
  if (!command.outputs.empty()) {
    std::vector<std::pair<std::string, std::string>> files;
    for (const OutputFile& file : command.outputs) files.emplace_back(file.name, file.content);
    text += "\nFiles written:\n" + table(files);
  }
  return text + examples_of(command) + "\n" +
         wrapped("Exit code: " + for_terminal(command.exit_codes), 0, 0) + ".\n";
}

std::string program_help(const CommandLine& line) {
  std::vector<std::pair<std::string, std::string>> rows;
  for (const CommandLine::Entry& entry : line.entries)
    if (entry.command->name.find(' ') == std::string::npos)
      rows.emplace_back(entry.command->name, entry.command->summary);
  return fmt::format(
      "biopsy COMMAND [options]\n\n{}\n\nCommands:\n{}\nOptions:\n  -h, --help  this text\n  --version   "
      "version, commit and libraries\n\nStart with:\n  biopsy dry-run --out out/first\n\n"
      "Each command explains itself: biopsy COMMAND --help\n",
      line.app->get_description(), table(rows));
}

// Text inside a cell of a table.
std::string cell(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2))
    text.insert(at, "\\");
  return text;
}

std::string markdown_of(const CommandLine& line, const CommandLine::Entry& entry) {
  const Command& command = *entry.command;
  const bool is_part = command.name.find(' ') != std::string::npos;
  std::string out =
      fmt::format("\n{} `biopsy {}`\n\n{}{}.\n", is_part ? "####" : "###", command.name,
                  static_cast<char>(std::toupper(command.summary.front())), command.summary.substr(1));
  if (!command.description.empty()) out += "\n" + command.description + "\n";
  if (is_group(entry)) return out;
  out += fmt::format("\n`{}`\n\n| option | meaning |\n|---|---|\n", usage(entry));
  for (const OptionFacts& option : options_of(*entry.app))
    out += fmt::format("| `{}{}` | {} |\n", option.name, option.value.empty() ? "" : " " + option.value,
                       cell(option.meaning));
  if (!command.outputs.empty()) {
    out += "\n| file | content |\n|---|---|\n";
    for (const OutputFile& file : command.outputs)
      out += fmt::format("| `{}` | {} |\n", file.name, cell(file.content));
  }
  if (!command.json.empty()) out += fmt::format("\nWith `--json`: {}.\n", command.json);
  out += fmt::format("\nExit code: {}.\n", command.exit_codes);
  if (!command.examples.empty()) out += fmt::format("\n```sh\n{}\n```\n", fmt::join(command.examples, "\n"));
  for (const std::string& example : command.long_examples) out += fmt::format("\nExample: `{}`\n", example);
  static_cast<void>(line);
  return out;
}

}  // namespace

std::vector<OptionFacts> options_of(const CLI::App& app) {
  std::vector<OptionFacts> all;
  for (const CLI::Option* option : app.get_options()) {
    if (option == app.get_help_ptr()) continue;
    OptionFacts facts{
        option->get_positional() ? option->get_single_name() : "--" + option->get_lnames().at(0),
        value_of(*option), option->get_description(), option->get_required()};
    if (const std::string range = range_of(*option); !range.empty()) facts.meaning += ", " + range;
    if (!option->get_needs().empty()) facts.meaning += "; only with " + joined(option->get_needs());
    if (!option->get_excludes().empty()) facts.meaning += "; not with " + joined(option->get_excludes());
    if (facts.required) facts.meaning += ". Required";
    if (!option->get_default_str().empty()) facts.meaning += ". Default: " + option->get_default_str();
    all.push_back(std::move(facts));
  }
  std::stable_partition(all.begin(), all.end(),
                        [](const OptionFacts& o) { return !o.name.starts_with("-"); });
  return all;
}

std::string help_of(const CommandLine& line, const std::string& command) {
  for (const CommandLine::Entry& entry : line.entries)
    if (entry.command->name == command) return help_text(line, entry);
  return program_help(line);
}

std::string help_of(const CommandLine& line) {
  std::string name;
  for (const CLI::App* app = line.app.get(); !app->get_subcommands().empty();) {
    app = app->get_subcommands().back();
    name += (name.empty() ? "" : " ") + app->get_name();
  }
  return help_of(line, name);
}

std::string reference_markdown(const CommandLine& line) {
  std::string out =
      "\n`biopsy --version` prints version, commit and libraries; `biopsy COMMAND --help` explains a "
      "command.\n"
      "This section is generated; a test compares it with the program: `biopsy help --markdown`. Every "
      "command has "
      "these options, which may also stand before it:\n\n| option | meaning |\n|---|---|\n";
  for (const OptionFacts& option : options_of(*line.app))
    if (!option.value.empty())
      out += fmt::format("| `{} {}` | {} |\n", option.name, option.value, option.meaning);
  for (const CommandLine::Entry& entry : line.entries) out += markdown_of(line, entry);
  return out;
}

std::string registry_json(const CommandLine& line) {
  using Json = nlohmann::ordered_json;
  Json commands = Json::array();
  for (const CommandLine::Entry& entry : line.entries) {
    const Command& command = *entry.command;
    if (is_group(entry)) continue;
    Json options = Json::array(), outputs = Json::array();
    for (const OptionFacts& option : options_of(*entry.app))
      options.push_back({{"name", option.name},
                         {"value", option.value},
                         {"meaning", option.meaning},
                         {"required", option.required}});
    for (const OutputFile& file : command.outputs)
      outputs.push_back({{"name", file.name}, {"content", file.content}});
    std::vector<std::string> examples = command.examples;
    examples.insert(examples.end(), command.long_examples.begin(), command.long_examples.end());
    commands.push_back({{"name", command.name},
                        {"summary", command.summary},
                        {"options", options},
                        {"outputs", outputs},
                        {"examples", examples},
                        {"exit_codes", command.exit_codes}});
  }
  return commands.dump(2) + "\n";
}

}  // namespace biopsy::robot
