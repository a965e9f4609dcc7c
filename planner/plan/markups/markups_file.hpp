// Points that people placed in 3D Slicer, or in a program that writes its files: markups (.mrk.json, schema
// 1.x) and lists of fiducials (.fcsv, of Slicer 4 and 5).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robot/common/frames.hpp"

namespace biopsy::planner {

struct MarkupPoint {
  std::string label;
  std::optional<Point> p_S;  // LPS mm; nothing where the point was announced but not placed
  std::string place;         // for messages
};

// All control points of all markups in the file, in its order. Throws ConfigError naming the place: a format
// or schema that is not known, a frame other than LPS and RAS or none where none is certain, units other than
// mm, a coordinate that is no number or further than 2 m from the scanner's centre.
std::vector<MarkupPoint> read_markups(const std::filesystem::path& file);

// The same by content, for a name that ends in .json or .fcsv.
std::vector<MarkupPoint> parse_markups(const std::string& text, const std::string& file_name);

// The one point with this label, upper case like lower case. Throws ConfigError where there is none, more
// than one, or one that was not placed.
Point point_labelled(const std::vector<MarkupPoint>& points, const std::string& label,
                     const std::string& file_name);

}  // namespace biopsy::planner
