#include "robot/common/files/toml_reader.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "robot/common/config_error.hpp"
#include "robot/common/files/toml_library.hpp"

namespace biopsy::sim {

struct TomlTable::Node {
  std::string file;
  std::shared_ptr<const toml::table> root;
  const toml::table* table;
};

namespace {

std::string at_line(const std::string& file, const toml::node& node) {
  return fmt::format("{}:{}", file, node.source().begin.line);
}

double finite(const toml::node& node, std::string_view name, const std::string& where) {
  const auto value = node.value<double>();
  if (!value || !(node.is_floating_point() || node.is_integer()) || !std::isfinite(*value))
    throw ConfigError(fmt::format("`{}` is not a finite number", name), where, "write a finite number");
  return *value;
}

double ranged(double value, std::string_view name, double low, double high, const std::string& where) {
  if (value < low || value > high)
    throw ConfigError(fmt::format("`{}` = {} is outside [{}, {}]", name, value, low, high), where,
                      "check the unit: it stands in the name or beside it in docs/explanation/model.md");
  return value;
}

}  // namespace

TomlTable::TomlTable(std::shared_ptr<const Node> node) : node_(std::move(node)) {}

std::vector<std::string> TomlTable::names() const {
  std::vector<std::string> out;
  for (const auto& [key, value] : *node_->table) out.emplace_back(key.str());
  return out;
}

bool TomlTable::has(std::string_view name) const {
  return node_->table->contains(name);
}

bool TomlTable::holds_table(std::string_view name) const {
  const toml::node* node = node_->table->get(name);
  return node != nullptr && node->is_table();
}

std::string TomlTable::where() const {
  return at_line(node_->file, *node_->table);
}

std::string TomlTable::place(std::string_view name) const {
  const toml::node* node = node_->table->get(name);
  if (node == nullptr)
    throw ConfigError(fmt::format("`{}` is missing", name), where(), fmt::format("add `{}`", name));
  return at_line(node_->file, *node);
}

double TomlTable::number(std::string_view name, double low, double high) {
  const std::string line = place(name);
  known_.emplace(name);
  const toml::node* node = node_->table->get(name);
  if (const toml::table* described = node->as_table()) {
    node = described->get("value");
    if (node == nullptr)
      throw ConfigError(fmt::format("`{}` is a table without `value`", name), line,
                        "write a number, or { value = ..., std = ..., source = \"...\" }");
  }
  return ranged(finite(*node, name, line), name, low, high, line);
}

std::string TomlTable::text(std::string_view name) {
  const std::string line = place(name);
  known_.emplace(name);
  const auto value = node_->table->get(name)->value<std::string>();
  if (!value)
    throw ConfigError(fmt::format("`{}` is not a text", name), line, fmt::format("write {} = \"...\"", name));
  return *value;
}

std::vector<double> TomlTable::numbers(std::string_view name, double low, double high) {
  const std::string line = place(name);
  known_.emplace(name);
  const toml::array* array = node_->table->get(name)->as_array();
  if (array == nullptr)
    throw ConfigError(fmt::format("`{}` is not a list of numbers", name), line,
                      fmt::format("write {} = [1.0, 2.0]", name));
  std::vector<double> out;
  for (const toml::node& element : *array)
    out.push_back(ranged(finite(element, name, line), name, low, high, line));
  return out;
}

std::vector<std::string> TomlTable::texts(std::string_view name) {
  const std::string line = place(name);
  known_.emplace(name);
  const toml::array* array = node_->table->get(name)->as_array();
  if (array == nullptr || !(array->empty() || array->is_homogeneous(toml::node_type::string)))
    throw ConfigError(fmt::format("`{}` is not a list of texts", name), line,
                      fmt::format("write {} = [\"one\", \"two\"]", name));
  std::vector<std::string> out;
  for (const toml::node& element : *array) out.push_back(*element.value<std::string>());
  return out;
}

bool TomlTable::flag(std::string_view name) {
  const std::string line = place(name);
  known_.emplace(name);
  const toml::node* node = node_->table->get(name);
  if (!node->is_boolean())
    throw ConfigError(fmt::format("`{}` is neither true nor false", name), line, "write true or false");
  return *node->value<bool>();
}

TomlTable TomlTable::table(std::string_view name) {
  const std::string line = place(name);
  known_.emplace(name);
  const toml::table* inner = node_->table->get(name)->as_table();
  if (inner == nullptr)
    throw ConfigError(fmt::format("`{}` is not a table", name), line, fmt::format("write [{}]", name));
  return TomlTable(std::make_shared<Node>(Node{node_->file, node_->root, inner}));
}

std::vector<TomlTable> TomlTable::tables(std::string_view name) {
  std::vector<TomlTable> out;
  if (!has(name)) return out;
  const std::string line = place(name);
  known_.emplace(name);
  const toml::array* array = node_->table->get(name)->as_array();
  if (array == nullptr || !array->is_array_of_tables())
    throw ConfigError(fmt::format("`{}` is not a list of tables", name), line,
                      fmt::format("write [[{}]]", name));
  for (const toml::node& element : *array)
    out.emplace_back(std::make_shared<Node>(Node{node_->file, node_->root, element.as_table()}));
  return out;
}

void TomlTable::ignore(std::string_view name) {
  known_.emplace(name);
}

void TomlTable::refuse_rest() const {
  std::string known;
  for (const std::string& name : known_) known += (known.empty() ? "" : ", ") + name;
  for (const auto& [key, value] : *node_->table)
    if (!known_.contains(key.str()))
      throw ConfigError(fmt::format("unknown name `{}`", key.str()), at_line(node_->file, value),
                        fmt::format("known here: {}", known));
}

TomlTable parse_toml(const std::string& text, const std::string& name) {
  try {
    auto root = std::make_shared<const toml::table>(toml::parse(text, name));
    return TomlTable(std::make_shared<TomlTable::Node>(TomlTable::Node{name, root, root.get()}));
  } catch (const toml::parse_error& error) {
    throw ConfigError(std::string(error.description()), fmt::format("{}:{}", name, error.source().begin.line),
                      "the file must be TOML 1.0");
  }
}

TomlTable read_toml(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file))
    throw ConfigError("cannot be opened", file.string(), "give the path of a TOML file");
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_toml(text.str(), file.string());
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (letter == '"' || letter == '\\')
      out += {'\\', letter};
    else if (code < 0x20 || code == 0x7f)
      out += fmt::format("\\u{:04x}", code);
    else
      out += letter;
  }
  return out + '"';
}

}  // namespace biopsy::sim
