#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "planner/plan/markups/markups_formats.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy::planner {
namespace {

// Cells between commas; one in double quotes may hold commas, and "" for a quote.
std::vector<std::string> cells_of(std::string_view row) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t n = 0; n < row.size(); ++n) {
    const char c = row[n];
    if (c == '"' && quoted && n + 1 < row.size() && row[n + 1] == '"') {
      cells.back() += row[++n];
    } else if (c == '"' && (quoted || cells.back().empty())) {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  for (std::string& cell : cells) cell = std::string(trimmed(cell));
  return cells;
}

// What the lines that begin with # say, and the rows with their places.
struct Lines {
  std::optional<std::string> version, frame, columns;
  std::vector<std::pair<std::string, std::vector<std::string>>> rows;
};

void take_head(std::string_view line, const std::string& place, Lines& lines) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return;  // a remark
  const std::string_view name = trimmed(line.substr(1, equals - 1));
  std::optional<std::string>* field = name == "Markups fiducial file version" ? &lines.version
                                      : name == "CoordinateSystem"            ? &lines.frame
                                      : name == "columns"                     ? &lines.columns
                                                                              : nullptr;
  if (field == nullptr) return;
  if (*field) refuse_markups(fmt::format("the line \"# {} = ...\" is there twice", name), place);
  *field = std::string(trimmed(line.substr(equals + 1)));
}

Lines lines_of(std::string_view text, const std::string& file) {
  Lines lines;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::string place = fmt::format("{}:{}", file, number);
    if (line.starts_with('#'))
      take_head(line, place, lines);
    else if (!line.empty())
      lines.rows.emplace_back(place, cells_of(line));
  }
  return lines;
}

void refuse_other_versions(const Lines& lines, const std::string& file) {
  if (!lines.version)
    refuse_markups("no fiducials of 3D Slicer: the line \"# Markups fiducial file version = ...\" is missing",
                   file);
  if (!lines.version->starts_with("4.") && !lines.version->starts_with("5."))
    refuse_markups(
        fmt::format("version \"{:.40}\" is not read (those of Slicer 4 and 5 are)", plain(*lines.version)),
        file);
}

// Without the line, Slicer 4 took the numbers as RAS and Slicer 5 takes them as LPS.
bool is_ras(const Lines& lines, const std::string& file) {
  if (!lines.frame)
    refuse_markups("the line \"# CoordinateSystem = ...\" is missing: RAS or LPS is not certain", file);
  if (*lines.frame == "0" || *lines.frame == "RAS") return true;
  if (*lines.frame == "1" || *lines.frame == "LPS") return false;
  refuse_markups(
      fmt::format("the coordinate system \"{:.40}\" is neither RAS (0) nor LPS (1)", plain(*lines.frame)),
      file);
}

// Where the cells of a row are.
struct Columns {
  std::size_t x, label, count;
};

Columns columns_of(const Lines& lines, const std::string& file) {
  if (!lines.columns) refuse_markups("the line \"# columns = ...\" is missing", file);
  const std::vector<std::string> names = cells_of(*lines.columns);
  const auto place_of = [&](const char* name) {
    if (std::ranges::count(names, name) != 1)
      refuse_markups(fmt::format("column `{}` is missing or there twice", name), file);
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  const Columns columns{place_of("x"), place_of("label"), names.size()};
  if (place_of("y") != columns.x + 1 || place_of("z") != columns.x + 2)
    refuse_markups("the columns x, y, z do not follow each other", file);
  return columns;
}

// Slicer 5 writes two cells more than it names, the first of them the status of the position: 0 undefined,
// 1 preview, 2 defined.
bool is_placed(const std::vector<std::string>& cells, std::size_t columns, const std::string& place) {
  if (cells.size() == columns) return true;
  if (cells.size() != columns + 2)
    refuse_markups(fmt::format("{} cells, but the line \"# columns\" names {}", cells.size(), columns),
                   place);
  const std::string& status = cells[columns];
  if (status != "0" && status != "1" && status != "2")
    refuse_markups(fmt::format("the position status \"{:.40}\" is not known", plain(status)), place);
  return status == "2";
}

Point position_of(const std::vector<std::string>& cells, std::size_t x, bool ras, const std::string& place) {
  Point p;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::optional<double> coordinate = strict_number(cells[x + axis]);
    if (!coordinate)
      refuse_markups(
          fmt::format("column `{}`: \"{:.40}\" is not a finite number", "xyz"[axis], plain(cells[x + axis])),
          place);
    p[static_cast<Eigen::Index>(axis)] = *coordinate;
  }
  return markup_position(p, ras, place);
}

}  // namespace

std::vector<MarkupPoint> parse_fcsv(const std::string& text, const std::string& file_name) {
  const Lines lines = lines_of(text, file_name);
  refuse_other_versions(lines, file_name);
  const bool ras = is_ras(lines, file_name);
  const Columns columns = columns_of(lines, file_name);
  std::vector<MarkupPoint> points;
  for (const auto& [place, cells] : lines.rows) {
    MarkupPoint point{.label = {}, .p_S = std::nullopt, .place = place};
    const bool placed = is_placed(cells, columns.count, place);
    point.label = cells[columns.label];
    if (placed) point.p_S = position_of(cells, columns.x, ras, place);
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace biopsy::planner
