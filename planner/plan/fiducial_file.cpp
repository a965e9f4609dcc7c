#include "planner/plan/fiducial_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "robot/common/config_error.hpp"
#include "robot/common/files/csv_table.hpp"
#include "robot/common/files/file.hpp"

namespace biopsy::planner {
namespace {

constexpr std::string_view kName = "name";
constexpr std::array<std::string_view, 6> kCoordinates = {"robot_x_mm",   "robot_y_mm",   "robot_z_mm",
                                                          "scanner_r_mm", "scanner_a_mm", "scanner_s_mm"};
constexpr const char* kHeaderRemedy =
    "the header is name,robot_x_mm,robot_y_mm,robot_z_mm,scanner_r_mm,scanner_a_mm,scanner_s_mm";
constexpr double kReach_mm = 1000.0;  // nothing in a bore is further from the robot or the isocentre
constexpr double kSamePosition_mm =
    0.01;  // markers cannot be placed closer: a copied line, not a measurement

void check_header(const CsvTable& table) {
  for (const std::string_view column : table.names()) {
    if (column == kName || std::ranges::find(kCoordinates, column) != kCoordinates.end()) continue;
    const std::string_view stem = column.substr(0, column.rfind('_'));
    for (const std::string_view known : kCoordinates) {
      const std::string_view quantity = known.substr(0, known.rfind('_'));
      if (quantity == stem || quantity == column)
        throw ConfigError(fmt::format("column `{}` is not in millimetres", column), table.header_place(),
                          fmt::format("convert the numbers to mm and name the column {}", known));
    }
    throw ConfigError(fmt::format("unknown column `{}`", column), table.header_place(), kHeaderRemedy);
  }
  for (const std::string_view column : {kName, kCoordinates[0], kCoordinates[1], kCoordinates[2],
                                        kCoordinates[3], kCoordinates[4], kCoordinates[5]})
    if (!table.has(column))
      throw ConfigError(fmt::format("column `{}` is missing", column), table.header_place(), kHeaderRemedy);
}

void refuse_repetition(const std::vector<FiducialPair>& earlier, const FiducialPair& pair,
                       const std::string& place) {
  for (const FiducialPair& other : earlier) {
    if (other.name == pair.name)
      throw ConfigError(fmt::format("fiducial '{}' is there twice", pair.name), place,
                        "name each fiducial once");
    if ((other.p_RF - pair.p_RF).norm() < kSamePosition_mm ||
        (other.p_SF - pair.p_SF).norm() < kSamePosition_mm)
      throw ConfigError(fmt::format("fiducial '{}' is at the position of '{}'", pair.name, other.name), place,
                        "remove the line that was copied, or measure the fiducial again");
  }
}

}  // namespace

std::vector<FiducialPair> parse_fiducials(const std::string& text, const std::string& file_name) {
  const CsvTable table = CsvTable::parse(text, file_name);
  check_header(table);
  std::array<std::vector<double>, kCoordinates.size()> at;
  for (std::size_t n = 0; n < at.size(); ++n) at[n] = table.numbers(kCoordinates[n], -kReach_mm, kReach_mm);
  std::vector<FiducialPair> pairs;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    FiducialPair pair{.name = std::string(table.text(kName, row)),
                      .p_RF = {at[0][row], at[1][row], at[2][row]},
                      .p_SF = lps_from_ras({at[3][row], at[4][row], at[5][row]})};
    if (pair.name.empty())
      throw ConfigError("the fiducial has no name", table.place(row), "give each fiducial a name");
    refuse_repetition(pairs, pair, table.place(row));
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

std::vector<FiducialPair> read_fiducials(const std::filesystem::path& file) {
  return parse_fiducials(read_file(file), file.string());
}

}  // namespace biopsy::planner
