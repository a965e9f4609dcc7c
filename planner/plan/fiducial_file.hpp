// Reads the fiducial pairs a person measured: one line a fiducial, both frames, millimetres, scanner in RAS.
#pragma once

#include <filesystem>
#include <istream>
#include <string>
#include <vector>

#include "planner/plan/registration.hpp"

namespace biopsy::planner {

// Header `name,robot_x_mm,robot_y_mm,robot_z_mm,scanner_r_mm,scanner_a_mm,scanner_s_mm`, columns in any
// order; lines that start with # and empty lines are skipped. Anything else that is unexpected (a missing or
// unknown column, another unit, a number that is not one, NaN, a point further than 1 m from the origin, a
// name or a position given twice) throws ConfigError with file, line, column and remedy. RAS becomes LPS
// here.
std::vector<FiducialPair> read_fiducials(const std::filesystem::path& file);
std::vector<FiducialPair> read_fiducials(std::istream& text, const std::string& file_name);

}  // namespace biopsy::planner
