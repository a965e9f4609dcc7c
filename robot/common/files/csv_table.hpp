// A CSV file of numbers: one header line of column names, rows of finite numbers, lines that start with # are
// comments.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace biopsy::sim {

struct CsvTable {
  std::string file;
  std::size_t header_line = 1;                         // of the column names, from 1
  std::vector<std::string> names;                      // in file order
  std::map<std::string, std::vector<double>> columns;  // equal lengths
  std::vector<std::size_t> lines;                      // line of each row, from 1

  bool has(const std::string& name) const { return columns.contains(name); }
  const std::vector<double>& column(const std::string& name) const { return columns.at(name); }
};

// Throws ConfigError naming file, line and column.
CsvTable read_csv(const std::filesystem::path& file);

}  // namespace biopsy::sim
