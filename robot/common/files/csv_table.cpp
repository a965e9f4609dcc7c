#include "robot/common/files/csv_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy {
namespace {

std::string_view unquoted(std::string_view cell) {
  const bool quoted = cell.size() >= 2 && cell.front() == '"' && cell.back() == '"';
  return quoted ? trimmed(cell.substr(1, cell.size() - 2)) : cell;
}

char separator_of(std::string_view header) {
  for (const char separator : {';', '\t'})
    if (header.find(separator) != std::string_view::npos) return separator;
  return ',';
}

// "1,5" is 1.5 where commas separate no cells.
std::optional<double> number_of(std::string_view cell, char separator) {
  const std::size_t comma = cell.find(',');
  if (separator == ',' || comma == std::string_view::npos || cell.find('.') != std::string_view::npos)
    return strict_number(cell);
  std::string text(cell);
  text[comma] = '.';
  return strict_number(text);
}

}  // namespace

CsvTable CsvTable::parse(std::string text, std::string file_name) {
  CsvTable table;
  table.file_ = std::move(file_name);
  table.text_ = std::make_shared<const std::string>(std::move(text));
  std::string_view rest = *table.text_;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
  if (rest.starts_with("\xFF\xFE") || rest.starts_with("\xFE\xFF"))
    throw ConfigError("is UTF-16 text", table.file_, "save it as CSV in UTF-8");
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.empty() || line.front() == '#') continue;
    table.names_.empty() ? table.take_header(line, number) : table.take_row(line, number);
  }
  if (table.lines_.empty())
    throw ConfigError("holds no rows", table.file_, "give a header line of column names, then the rows");
  return table;
}

std::vector<std::string_view> CsvTable::cells_of(std::string_view line) const {
  std::vector<std::string_view> out;
  while (true) {
    const std::size_t end = line.find(separator_);
    out.push_back(unquoted(trimmed(line.substr(0, end))));
    if (end == std::string_view::npos) return out;
    line.remove_prefix(end + 1);
  }
}

void CsvTable::take_header(std::string_view line, std::size_t number) {
  header_line_ = number;
  separator_ = separator_of(line);
  for (const std::string_view name : cells_of(line)) {
    if (name.empty() || has(name))
      throw ConfigError(fmt::format("column \"{}\" is empty or there twice", name), header_place(),
                        "give each column one name with its unit, e.g. time_s");
    names_.push_back(name);
  }
}

void CsvTable::take_row(std::string_view line, std::size_t number) {
  const auto row = cells_of(line);
  lines_.push_back(number);
  if (row.size() != names_.size())
    throw ConfigError(fmt::format("{} cells, but the header names {} columns", row.size(), names_.size()),
                      place(rows() - 1), "give every row one cell for each column, numbers with a point");
  cells_.insert(cells_.end(), row.begin(), row.end());
}

bool CsvTable::has(std::string_view name) const {
  return column(name) < names_.size();
}

std::string CsvTable::header_place() const {
  return fmt::format("{}:{}", file_, header_line_);
}

std::string CsvTable::place(std::size_t row) const {
  return fmt::format("{}:{}", file_, lines_[row]);
}

std::size_t CsvTable::column(std::string_view name) const {
  return static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
}

std::string_view CsvTable::text(std::string_view name, std::size_t row) const {
  return cells_[row * names_.size() + column(name)];
}

std::vector<double> CsvTable::numbers(std::string_view name, double low, double high) const {
  std::vector<double> out;
  out.reserve(rows());
  const std::size_t at = column(name);
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::string_view cell = cells_[row * names_.size() + at];
    const auto value = number_of(cell, separator_);
    if (!value)
      throw ConfigError(fmt::format("column `{}`: \"{}\" is not a finite number", name, cell.substr(0, 40)),
                        place(row), "correct or remove the row");
    if (*value < low || *value > high)
      throw ConfigError(fmt::format("column `{}`: {} is outside [{}, {}]", name, *value, low, high),
                        place(row), "check the column's unit");
    out.push_back(*value);
  }
  return out;
}

CsvTable read_csv(const std::filesystem::path& file) {
  return CsvTable::parse(read_file(file), file.string());
}

}  // namespace biopsy
