#include "robot/common/files/toml_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>
#include <set>

#include "robot/common/config_error.hpp"
#include "robot/common/files/toml_library.hpp"

namespace biopsy {

struct TomlTable::Node {
  std::string file;
  std::shared_ptr<const toml::table> root;
  const toml::table* table;
  std::set<std::string, std::less<>> known{};
  std::vector<std::shared_ptr<Node>> children{};  // tables read from this one

  std::string line_of(const toml::node& node) const {
    return fmt::format("{}:{}", file, node.source().begin.line);
  }
  const toml::node& entry(std::string_view name) {
    known.emplace(name);
    if (const toml::node* node = table->get(name)) return *node;
    throw ConfigError(fmt::format("`{}` is missing", name), line_of(*table), fmt::format("add `{}`", name));
  }
  std::shared_ptr<Node> child(const toml::table& inner) {
    for (const auto& known_child : children)
      if (known_child->table == &inner) return known_child;
    return children.emplace_back(std::make_shared<Node>(Node{file, root, &inner}));
  }
  void refuse_unknown_names() const {
    for (const auto& [key, value] : *table)
      if (!known.contains(key.str()))
        throw ConfigError(fmt::format("unknown name `{}`", key.str()), line_of(value),
                          fmt::format("known here: {}", fmt::join(known, ", ")));
    for (const auto& inner : children) inner->refuse_unknown_names();
  }
};

namespace {

double ranged(const toml::node& node, std::string_view name, double low, double high, std::string_view unit,
              const TomlTable& table) {
  const auto value = node.value<double>();
  const std::string_view space = unit.empty() ? "" : " ";
  if (!value || !node.is_number() || !std::isfinite(*value))
    table.refuse(name, "is not a finite number", fmt::format("write a finite number{}{}", space, unit));
  if (*value < low || *value > high)
    table.refuse(
        name, fmt::format("= {}{}{} is outside [{}, {}]", *value, space, unit, low, high),
        unit.empty() ? "give a number within it" : fmt::format("give a number within it, in {}", unit));
  return *value;
}

}  // namespace

TomlTable TomlTable::parse(const std::string& text, const std::string& file_name) {
  try {
    auto root = std::make_shared<const toml::table>(toml::parse(text, file_name));
    return TomlTable(std::make_shared<Node>(Node{file_name, root, root.get()}));
  } catch (const toml::parse_error& error) {
    throw ConfigError(std::string(error.description()),
                      fmt::format("{}:{}", file_name, error.source().begin.line),
                      "the file must be TOML 1.0");
  }
}

std::vector<std::string> TomlTable::names() const {
  std::vector<std::string> out;
  for (const auto& [key, value] : *node_->table) out.emplace_back(key.str());
  return out;
}

bool TomlTable::has(std::string_view name) {
  node_->known.emplace(name);
  return node_->table->contains(name);
}

bool TomlTable::holds_table(std::string_view name) const {
  const toml::node* node = node_->table->get(name);
  return node != nullptr && node->is_table();
}

std::string TomlTable::where() const {
  return node_->line_of(*node_->table);
}

std::string TomlTable::place(std::string_view name) const {
  const toml::node* node = node_->table->get(name);
  return node_->line_of(node != nullptr ? *node : *node_->table);
}

double TomlTable::number(std::string_view name, double low, double high, std::string_view unit) {
  const toml::node* node = &node_->entry(name);
  if (const toml::table* described = node->as_table()) {
    const auto inner = node_->child(*described);
    inner->known.insert({"value", "std", "source"});
    node = described->get("value");
    if (node == nullptr)
      refuse(name, "is a table without `value`",
             "write a number, or { value = ..., std = ..., source = \"...\" }");
  }
  return ranged(*node, name, low, high, unit, *this);
}

std::uint32_t TomlTable::whole_number(std::string_view name, std::uint32_t high) {
  const double value = number(name, 0.0, high);
  if (value != std::floor(value)) refuse(name, "is not a whole number", "write a whole number");
  return static_cast<std::uint32_t>(value);
}

std::string TomlTable::text(std::string_view name) {
  const auto value = node_->entry(name).value<std::string>();
  if (!value || value->find('\0') != std::string::npos)
    refuse(name, "is not a text", fmt::format("write {} = \"...\"", name));
  return *value;
}

std::vector<double> TomlTable::numbers(std::string_view name, double low, double high) {
  const toml::array* array = node_->entry(name).as_array();
  if (array == nullptr) refuse(name, "is not a list of numbers", fmt::format("write {} = [1.0, 2.0]", name));
  std::vector<double> out;
  for (const toml::node& element : *array) out.push_back(ranged(element, name, low, high, "", *this));
  return out;
}

std::vector<std::string> TomlTable::texts(std::string_view name) {
  const toml::array* array = node_->entry(name).as_array();
  if (array == nullptr || !(array->empty() || array->is_homogeneous(toml::node_type::string)))
    refuse(name, "is not a list of texts", fmt::format("write {} = [\"one\", \"two\"]", name));
  std::vector<std::string> out;
  for (const toml::node& element : *array) out.push_back(*element.value<std::string>());
  return out;
}

bool TomlTable::flag(std::string_view name) {
  const toml::node& node = node_->entry(name);
  if (!node.is_boolean()) refuse(name, "is neither true nor false", "write true or false");
  return *node.value<bool>();
}

TomlTable TomlTable::table(std::string_view name) {
  const toml::table* inner = node_->entry(name).as_table();
  if (inner == nullptr) refuse(name, "is not a table", fmt::format("write [{}]", name));
  return TomlTable(node_->child(*inner));
}

std::vector<TomlTable> TomlTable::tables(std::string_view name) {
  std::vector<TomlTable> out;
  if (!has(name)) return out;
  const toml::array* array = node_->entry(name).as_array();
  if (array == nullptr || !array->is_array_of_tables())
    refuse(name, "is not a list of tables", fmt::format("write [[{}]]", name));
  for (const toml::node& element : *array) out.push_back(TomlTable(node_->child(*element.as_table())));
  return out;
}

void TomlTable::refuse(std::string_view name, const std::string& what, const std::string& remedy) const {
  throw ConfigError(fmt::format("`{}` {}", name, what), place(name), remedy);
}

void TomlTable::refuse_unknown_names() const {
  node_->refuse_unknown_names();
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

}  // namespace biopsy
