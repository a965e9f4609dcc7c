#include "drivers/nidaqmx/config_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>

#include "robot/common/config_error.hpp"
#include "robot/common/files/toml_library.hpp"

namespace biopsy::nidaqmx {

struct ConfigTable::Node {
  std::string file;
  std::shared_ptr<const toml::table> root;
  const toml::table* table;
};

std::string ConfigTable::place(std::string_view name) const {
  const toml::node* const node = node_->table->get(name);
  const toml::node& at = node != nullptr ? *node : *node_->table;
  return fmt::format("{}:{}", node_->file, at.source().begin.line);
}

void ConfigTable::refuse(std::string_view name, const std::string& what, const std::string& remedy) const {
  throw ConfigError(fmt::format("`{}` {}", name, what), place(name), remedy);
}

bool ConfigTable::has(std::string_view name) const {
  return node_->table->contains(name);
}

double ConfigTable::number(std::string_view name, double low, double high, std::string_view unit) {
  known_.emplace(name);
  const toml::node* const node = node_->table->get(name);
  if (node == nullptr) refuse(name, "is missing", fmt::format("add `{}`, in {}", name, unit));
  const auto value = node->value<double>();
  if (!value || !node->is_number() || !std::isfinite(*value))
    refuse(name, "is not a finite number", fmt::format("write a number, in {}", unit));
  if (*value < low || *value > high)
    refuse(name, fmt::format("= {} {} is outside [{}, {}]", *value, unit, low, high), "check the unit");
  return *value;
}

std::uint32_t ConfigTable::whole(std::string_view name, std::uint32_t high) {
  const double value = number(name, 0.0, high, "whole numbers");
  if (value != std::floor(value)) refuse(name, "is not a whole number", "write a whole number");
  return static_cast<std::uint32_t>(value);
}

std::string ConfigTable::text(std::string_view name) {
  known_.emplace(name);
  const toml::node* const node = node_->table->get(name);
  if (node == nullptr) refuse(name, "is missing", fmt::format("add {} = \"...\"", name));
  const auto value = node->value<std::string>();
  // A zero byte would end the name halfway on its way into a C function.
  if (!value || value->empty() || value->size() > 255 || value->find('\0') != std::string::npos)
    refuse(name, "is not a name", fmt::format("write {} = \"...\"", name));
  return *value;
}

std::uint32_t ConfigTable::numbered(std::string_view name, std::string_view prefix, std::uint32_t high) {
  const std::string value = text(name);
  std::uint32_t number = 0;
  const char* const first = value.data() + std::min(prefix.size(), value.size());
  const char* const last = value.data() + value.size();
  const auto [end, error] = std::from_chars(first, last, number);
  if (!value.starts_with(prefix) || error != std::errc() || end != last || number > high)
    refuse(name, fmt::format("= \"{}\" is none of {}0 to {}{}", value, prefix, prefix, high),
           "give the name that stands on the board, without the device");
  return number;
}

ConfigTable ConfigTable::table(std::string_view name) {
  known_.emplace(name);
  const toml::node* const node = node_->table->get(name);
  if (node == nullptr) refuse(name, "is missing", fmt::format("add a table [{}]", name));
  if (!node->is_table()) refuse(name, "is not a table", fmt::format("write [{}]", name));
  return ConfigTable(std::make_shared<Node>(Node{node_->file, node_->root, node->as_table()}));
}

void ConfigTable::refuse_rest() const {
  for (const auto& [key, value] : *node_->table)
    if (!known_.contains(key.str()))
      refuse(key.str(), "is unknown", fmt::format("known here: {}", fmt::join(known_, ", ")));
}

ConfigTable parse_config_table(const std::string& text, const std::string& name) {
  try {
    auto root = std::make_shared<const toml::table>(toml::parse(text, name));
    return ConfigTable(std::make_shared<ConfigTable::Node>(ConfigTable::Node{name, root, root.get()}));
  } catch (const toml::parse_error& error) {
    throw ConfigError(std::string(error.description()), fmt::format("{}:{}", name, error.source().begin.line),
                      "the file must be TOML 1.0");
  }
}

}  // namespace biopsy::nidaqmx
