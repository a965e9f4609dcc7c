// A table of figures in the documentation is the one that a run wrote into docs/reference/figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "tests/architecture/lines_of.hpp"
#include "tests/kept_figures.hpp"

namespace {

namespace fs = std::filesystem;

std::string markdown(const std::vector<std::string>& row) {
  std::string line = "|";
  for (const std::string& cell : row) line += (cell.empty() ? " |" : " " + cell + " |");
  return line;
}

std::vector<std::vector<std::string>> tables_of(const fs::path& document) {
  std::vector<std::vector<std::string>> tables;
  bool inside = false;
  for (const std::string& line : lines_of(document)) {
    const bool is_row = line.starts_with("|");
    if (is_row && !inside) tables.emplace_back();
    if (is_row) tables.back().push_back(line);
    inside = is_row;
  }
  return tables;
}

// Each table of a document that has one kept row has no other row than kept ones beside its head.
TEST(Figures, StandInTheDocumentsAsTheRunsWroteThem) {
  std::map<std::string, std::set<std::string>> kept;  // by document
  for (const auto& entry : fs::directory_iterator(biopsy::source_dir() / "docs/reference/figures")) {
    const biopsy::KeptFigures figures = biopsy::read_figures(entry.path().stem().string());
    EXPECT_FALSE(figures.rows.empty() || figures.command.empty()) << entry.path();
    for (const std::vector<std::string>& row : figures.rows) kept[figures.document].insert(markdown(row));
  }
  ASSERT_FALSE(kept.empty());
  for (const auto& [document, rows] : kept) {
    std::set<std::string> stated;
    for (const std::vector<std::string>& table : tables_of(biopsy::source_dir() / "docs" / document)) {
      if (std::ranges::none_of(table, [&](const std::string& line) { return rows.contains(line); })) continue;
      for (std::size_t i = 2; i < table.size(); ++i)
        EXPECT_TRUE(rows.contains(table[i])) << document << ": no run wrote " << table[i];
      stated.insert(table.begin() + 2, table.end());
    }
    for (const std::string& row : rows) EXPECT_TRUE(stated.contains(row)) << document << " lacks " << row;
  }
}

}  // namespace
