#include "robot/common/files/csv_table.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include "robot/common/config_error.hpp"
#include "robot/common/number_text.hpp"

namespace biopsy::sim {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r'))
    text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> cells(std::string_view line) {
  std::vector<std::string_view> out;
  while (true) {
    const std::size_t comma = line.find(',');
    out.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return out;
    line.remove_prefix(comma + 1);
  }
}

double finite(std::string_view cell, const std::string& file, std::size_t line, const std::string& column) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
    throw ConfigError(fmt::format("column `{}`: \"{}\" is not a finite number", column, cell.substr(0, 40)),
                      fmt::format("{}:{}", file, line),
                      "mend or remove the row; a gap cannot be simulated through");
  return value;
}

void read_header(CsvTable& table, std::string_view line, std::size_t number) {
  table.header_line = number;
  for (const std::string_view name : cells(line)) {
    if (name.empty() || table.columns.contains(std::string(name)))
      throw ConfigError(fmt::format("column \"{}\" is empty or there twice", name),
                        fmt::format("{}:{}", table.file, number),
                        "give each column one name with its unit, e.g. time_s");
    table.names.emplace_back(name);
    table.columns[std::string(name)];
  }
}

void read_row(CsvTable& table, std::string_view line, std::size_t number) {
  const auto row = cells(line);
  if (row.size() != table.names.size())
    throw ConfigError(fmt::format("{}, but the header names {}", report::counted(row.size(), "cell"),
                                  report::counted(table.names.size(), "column")),
                      fmt::format("{}:{}", table.file, number), "give every row one number for each column");
  for (std::size_t i = 0; i < row.size(); ++i)
    table.columns[table.names[i]].push_back(finite(row[i], table.file, number, table.names[i]));
  table.lines.push_back(number);
}

}  // namespace

CsvTable read_csv(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw ConfigError("cannot be opened", file.string(), "check the file name in dataset.toml");
  CsvTable table;
  table.file = file.string();
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    if (table.names.empty())
      read_header(table, text, number);
    else
      read_row(table, text, number);
  }
  if (table.lines.empty())
    throw ConfigError("holds no rows", table.file, "give a header line and at least two rows");
  return table;
}

}  // namespace biopsy::sim
