// Strict reading of one TOML table of the stage's configuration: numbers range-checked, names checked,
// unknown entries refused, every error with file and line.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace biopsy::nidaqmx {

class ConfigTable {
 public:
  struct Node;  // the library's table, and its file

  explicit ConfigTable(std::shared_ptr<const Node> node) : node_(std::move(node)) {}

  bool has(std::string_view name) const;
  // All throw ConfigError where the entry is missing or is not what is asked for.
  double number(std::string_view name, double low, double high, std::string_view unit);
  std::uint32_t whole(std::string_view name, std::uint32_t high);
  std::string text(std::string_view name);
  // A text of the form PREFIX followed by a whole number of at most `high`: "ai0", "port1".
  std::uint32_t numbered(std::string_view name, std::string_view prefix, std::uint32_t high);
  ConfigTable table(std::string_view name);

  void refuse_rest() const;
  [[noreturn]] void refuse(std::string_view name, const std::string& what, const std::string& remedy) const;

 private:
  std::string place(std::string_view name) const;  // file:line

  std::shared_ptr<const Node> node_;
  std::set<std::string, std::less<>> known_;
};

ConfigTable parse_config_table(const std::string& text, const std::string& name);

}  // namespace biopsy::nidaqmx
