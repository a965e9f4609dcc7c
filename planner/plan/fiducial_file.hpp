// Fiducial pairs as measured: a CSV file, one row a fiducial, both frames, millimetres, scanner in RAS.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/plan/registration.hpp"

namespace biopsy::planner {

// Columns, in any order: name, robot_x_mm, robot_y_mm, robot_z_mm, scanner_r_mm, scanner_a_mm, scanner_s_mm.
// Scanner coordinates become LPS. Throws ConfigError with file and line: a column missing, unknown or in
// another unit; a cell that is no number or further than 1 m from the origin; a name or position given twice.
std::vector<FiducialPair> read_fiducials(const std::filesystem::path& file);
std::vector<FiducialPair> parse_fiducials(const std::string& text, const std::string& file_name);

}  // namespace biopsy::planner
