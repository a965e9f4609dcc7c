// What the program found, as it goes into the JSON: figures by name, tables by name, and whether all holds.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

namespace biopsy::explore {

struct Report {
  bool passed = true;
  nlohmann::ordered_json figures = nlohmann::ordered_json::object();
  nlohmann::ordered_json tables = nlohmann::ordered_json::object();

  void require(bool holds) { passed = passed && holds; }
};

// Writes {"tool", "passed", "figures", "tables"}, whole or not at all. Throws ConfigError where it cannot.
void write(const Report& report, std::string_view tool, const std::filesystem::path& file);

}  // namespace biopsy::explore
