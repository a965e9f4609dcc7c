#include "planner/plan/fiducial_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>
#include <system_error>

#include "robot/common/config_error.hpp"

namespace biopsy::planner {
namespace {

constexpr std::array<std::string_view, 7> kColumns = {
    "name", "robot_x_mm", "robot_y_mm", "robot_z_mm", "scanner_r_mm", "scanner_a_mm", "scanner_s_mm"};
constexpr std::string_view kHeaderRemedy =
    "the header is name,robot_x_mm,robot_y_mm,robot_z_mm,scanner_r_mm,scanner_a_mm,scanner_s_mm";
constexpr double kReach_mm = 1000.0;  // nothing in a scanner's bore is further from robot or isocentre
constexpr double kSamePosition_mm =
    0.01;  // closer than any marker can be placed: a line copied, not measured

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  return first == text.npos ? std::string_view{}
                            : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t start = 0;;) {
    const auto comma = line.find(',', start);
    fields.push_back(trimmed(line.substr(start, comma - start)));
    if (comma == line.npos) return fields;
    start = comma + 1;
  }
}

// Where in the file the reader is, for messages.
struct Place {
  std::string file;
  int line = 0;

  std::string whole_line() const { return fmt::format("{}, line {}", file, line); }
  std::string column(std::size_t number, std::string_view name) const {
    return fmt::format("{}, line {}, column {} ({})", file, line, number + 1, name);
  }
};

[[noreturn]] void refuse_header_field(std::string_view field, std::size_t column, const Place& place) {
  const std::string_view stem = field.substr(0, field.rfind('_'));
  for (const std::string_view known : kColumns)
    if (known != kColumns[0] &&
        (known.substr(0, known.size() - 3) == stem || known.substr(0, known.size() - 3) == field))
      throw ConfigError(fmt::format("'{}' is not in millimetres", field), place.column(column, field),
                        fmt::format("convert the numbers to mm and name the column {}", known));
  throw ConfigError(fmt::format("unknown column '{}'", field), place.column(column, field),
                    std::string(kHeaderRemedy));
}

// For each known column its position in the line.
std::array<std::size_t, 7> read_header(std::string_view line, const Place& place) {
  const auto fields = fields_of(line);
  for (std::size_t n = 0; n < fields.size(); ++n) {
    if (std::find(kColumns.begin(), kColumns.end(), fields[n]) == kColumns.end())
      refuse_header_field(fields[n], n, place);
    if (std::find(fields.begin(), fields.begin() + static_cast<std::ptrdiff_t>(n), fields[n]) !=
        fields.begin() + static_cast<std::ptrdiff_t>(n))
      throw ConfigError(fmt::format("column '{}' is there twice", fields[n]), place.column(n, fields[n]),
                        "remove one of the two");
  }
  std::array<std::size_t, 7> position{};
  for (std::size_t known = 0; known < kColumns.size(); ++known) {
    const auto found = std::find(fields.begin(), fields.end(), kColumns[known]);
    if (found == fields.end())
      throw ConfigError(fmt::format("column '{}' is missing", kColumns[known]), place.whole_line(),
                        std::string(kHeaderRemedy));
    position[known] = static_cast<std::size_t>(found - fields.begin());
  }
  return position;
}

double read_number(std::string_view text, const std::string& where) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(number))
    throw ConfigError(fmt::format("'{}' is not a number", text), where,
                      "write a number in mm with a decimal point");
  if (std::abs(number) > kReach_mm)
    throw ConfigError(fmt::format("{} mm is further than {} mm from the origin", text, kReach_mm), where,
                      "check the unit: coordinates are in mm");
  return number;
}

FiducialPair read_pair(std::string_view line, const std::array<std::size_t, 7>& position,
                       const Place& place) {
  const auto fields = fields_of(line);
  if (fields.size() != kColumns.size())
    throw ConfigError(fmt::format("{} fields instead of {}", fields.size(), kColumns.size()),
                      place.whole_line(),
                      "one comma between two fields, and a point, not a comma, in numbers");
  FiducialPair pair{.name = std::string(fields[position[0]])};
  if (pair.name.empty())
    throw ConfigError("the fiducial has no name", place.column(position[0], kColumns[0]),
                      "give each fiducial a name");
  std::array<double, 6> number{};
  for (std::size_t n = 0; n < number.size(); ++n)
    number[n] = read_number(fields[position[n + 1]], place.column(position[n + 1], kColumns[n + 1]));
  pair.p_RF = {number[0], number[1], number[2]};
  pair.p_SF = lps_from_ras({number[3], number[4], number[5]});
  return pair;
}

void refuse_repetition(const std::vector<FiducialPair>& earlier, const FiducialPair& pair, const Place& place,
                       std::size_t name_column) {
  for (const FiducialPair& other : earlier) {
    if (other.name == pair.name)
      throw ConfigError(fmt::format("fiducial '{}' is there twice", pair.name),
                        place.column(name_column, "name"), "name each fiducial once");
    if ((other.p_RF - pair.p_RF).norm() < kSamePosition_mm ||
        (other.p_SF - pair.p_SF).norm() < kSamePosition_mm)
      throw ConfigError(fmt::format("fiducial '{}' is at the position of '{}'", pair.name, other.name),
                        place.whole_line(), "remove the line that was copied, or measure the fiducial again");
  }
}

}  // namespace

std::vector<FiducialPair> read_fiducials(std::istream& text, const std::string& file_name) {
  Place place{file_name};
  std::vector<FiducialPair> pairs;
  std::array<std::size_t, 7> position{};
  bool header_read = false;
  for (std::string raw; std::getline(text, raw);) {
    ++place.line;
    std::string_view line = raw;
    if (place.line == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);  // spreadsheets begin so
    line = trimmed(line);
    if (line.empty() || line.starts_with('#')) continue;
    if (!header_read) {
      position = read_header(line, place);
      header_read = true;
      continue;
    }
    FiducialPair pair = read_pair(line, position, place);
    refuse_repetition(pairs, pair, place, position[0]);
    pairs.push_back(std::move(pair));
  }
  if (!header_read) throw ConfigError("the file is empty", file_name, std::string(kHeaderRemedy));
  return pairs;
}

std::vector<FiducialPair> read_fiducials(const std::filesystem::path& file) {
  std::ifstream text(file);
  if (!text || !std::filesystem::is_regular_file(file))
    throw ConfigError("the file cannot be read", file.string(), "check the path and the permissions");
  return read_fiducials(text, file.string());
}

}  // namespace biopsy::planner
