// Strict reading of TOML 1.0: every number is checked against a range, every name that was not asked for is
// refused, every error gives file and line. Keeps the TOML library out of the other files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robot/common/files/file.hpp"

namespace biopsy {

// One table of a file. Asking for an entry, also with has(), makes its name a known one.
class TomlTable {
 public:
  static TomlTable parse(const std::string& text, const std::string& file_name);

  std::vector<std::string> names() const;
  bool has(std::string_view name);
  void ignore(std::string_view name) { has(name); }
  bool holds_table(std::string_view name) const;
  std::string where() const;                       // file:line of the table
  std::string place(std::string_view name) const;  // file:line of an entry; of the table where it is missing

  // All throw ConfigError where the entry is missing or is not what is asked for.
  // Within [low, high], the unit being for messages. { value = 1.0, std = 0.1, source = "a" } counts as its
  // value.
  double number(std::string_view name, double low, double high, std::string_view unit = "");
  std::uint32_t whole_number(std::string_view name, std::uint32_t high);
  std::string text(std::string_view name);  // without zero bytes, which end a text for functions of C
  std::vector<double> numbers(std::string_view name, double low, double high);
  std::vector<std::string> texts(std::string_view name);
  bool flag(std::string_view name);
  TomlTable table(std::string_view name);
  std::vector<TomlTable> tables(std::string_view name);  // none if absent

  // Throws ConfigError "`name` WHAT" with the entry's line.
  [[noreturn]] void refuse(std::string_view name, const std::string& what, const std::string& remedy) const;
  // Throws at the first name, of this table or of one read from it, that was not asked for.
  void refuse_unknown_names() const;

 private:
  struct Node;  // the library's table, and what was asked for

  explicit TomlTable(std::shared_ptr<Node> node) : node_(std::move(node)) {}

  std::shared_ptr<Node> node_;
};

// What `read` makes of a whole file; names that it does not ask for are refused. Throws ConfigError.
template <class Read>
auto parse_toml(const std::string& text, const std::string& file_name, Read&& read) {
  TomlTable root = TomlTable::parse(text, file_name);
  auto result = std::forward<Read>(read)(root);
  root.refuse_unknown_names();
  return result;
}

template <class Read>
auto read_toml(const std::filesystem::path& file, Read&& read) {
  return parse_toml(read_file(file, "give the path of a TOML file"), file.string(), std::forward<Read>(read));
}

std::string quoted(const std::string& text);  // as a basic string of TOML

}  // namespace biopsy
