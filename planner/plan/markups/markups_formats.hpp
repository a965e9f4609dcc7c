// The two formats of markups_file.hpp.
#pragma once

#include <string>
#include <vector>

#include "planner/plan/markups/markups_file.hpp"

namespace biopsy::planner {

[[noreturn]] void refuse_markups(const std::string& what, const std::string& place);

// LPS. Refuses a point further than 2 m from the scanner's centre: no scanner's field is wider.
Point markup_position(const Point& p, bool ras, const std::string& place);

std::vector<MarkupPoint> parse_markups_json(const std::string& text, const std::string& file_name);
std::vector<MarkupPoint> parse_fcsv(const std::string& text, const std::string& file_name);

}  // namespace biopsy::planner
