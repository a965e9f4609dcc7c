// Strict reading of TOML: every number range-checked, every name that nobody asked for refused, every error
// with file and line. Keeps the TOML library out of the other files.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace biopsy::sim {

// One table of a file. Names that were read count as known; refuse_rest() throws at the first other one.
class TomlTable {
 public:
  struct Node;  // the library's table, and its file

  explicit TomlTable(std::shared_ptr<const Node> node);

  std::vector<std::string> names() const;
  bool has(std::string_view name) const;
  bool holds_table(std::string_view name) const;   // { value, std, source } and not a plain number
  std::string where() const;                       // file:line of the table,
  std::string place(std::string_view name) const;  // and of one entry; throws where it is missing

  // All throw ConfigError where the entry is missing or is not what is asked for.
  double number(std::string_view name, double low, double high);  // or the `value` of { value, std, source }
  std::string text(std::string_view name);
  std::vector<double> numbers(std::string_view name, double low, double high);
  std::vector<std::string> texts(std::string_view name);
  bool flag(std::string_view name);
  TomlTable table(std::string_view name);
  std::vector<TomlTable> tables(std::string_view name);  // none if absent

  void ignore(std::string_view name);
  void refuse_rest() const;

 private:
  std::shared_ptr<const Node> node_;
  std::set<std::string, std::less<>> known_;
};

// Throw ConfigError where there is no file or it is no TOML.
TomlTable read_toml(const std::filesystem::path& file);
TomlTable parse_toml(const std::string& text, const std::string& name);

std::string quoted(const std::string& text);  // as a basic string of TOML

}  // namespace biopsy::sim
