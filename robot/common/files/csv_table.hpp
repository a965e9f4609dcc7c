// CSV: one header line of column names, then rows with one cell for each. Between cells there are commas, or
// semicolons or tabs where the header has them; then a number may have a decimal comma. A cell may stand in
// double quotes. Blanks around cells, empty lines, lines that begin with # and a byte order mark are skipped.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace biopsy {

class CsvTable {
 public:
  // Throws ConfigError naming file, line and column: no rows, a column without a name or named twice, a row
  // of another length.
  static CsvTable parse(std::string text, std::string file_name);

  const std::vector<std::string_view>& names() const { return names_; }  // in the file's order
  bool has(std::string_view name) const;
  std::size_t rows() const { return lines_.size(); }
  const std::string& file() const { return file_; }
  std::string header_place() const;          // file:line, lines counted from 1
  std::string place(std::size_t row) const;  // file:line

  // Of a column that is there.
  std::string_view text(std::string_view name, std::size_t row) const;
  // Each finite and within [low, high]. Throws ConfigError naming line and column.
  std::vector<double> numbers(std::string_view name, double low, double high) const;

 private:
  CsvTable() = default;
  std::size_t column(std::string_view name) const;
  std::vector<std::string_view> cells_of(std::string_view line) const;
  void take_header(std::string_view line, std::size_t number);
  void take_row(std::string_view line, std::size_t number);

  std::string file_;
  char separator_ = ',';
  std::shared_ptr<const std::string> text_;      // what names and cells look at
  std::vector<std::string_view> names_, cells_;  // cells row by row
  std::size_t header_line_ = 1;
  std::vector<std::size_t> lines_;  // of each row
};

CsvTable read_csv(const std::filesystem::path& file);

}  // namespace biopsy
