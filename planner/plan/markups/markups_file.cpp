#include "planner/plan/markups/markups_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "planner/plan/markups/markups_formats.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy::planner {
namespace {

constexpr std::size_t kListed = 12;  // labels in a message

std::string folded(std::string_view text) {
  std::string lower(trimmed(text));
  std::ranges::transform(lower, lower.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return lower;
}

std::string labels_of(const std::vector<MarkupPoint>& points) {
  if (points.empty()) return "it has no points";
  std::string text = "its labels are";
  for (std::size_t n = 0; n < std::min(points.size(), kListed); ++n)
    text += fmt::format("{} \"{:.40}\"", n == 0 ? "" : ",", plain(points[n].label));
  return text + (points.size() > kListed ? " and more" : "");
}

}  // namespace

void refuse_markups(const std::string& what, const std::string& place) {
  throw ConfigError(what, place, "save the points again in 3D Slicer, as \"Markups JSON\" (.mrk.json)");
}

Point markup_position(const Point& p, bool ras, const std::string& place) {
  constexpr double kFar_mm = 2000.0;
  if (!(p.cwiseAbs().maxCoeff() <= kFar_mm))
    refuse_markups("the point lies more than 2 m from the scanner's centre", place);
  return ras ? lps_from_ras(p) : p;
}

std::vector<MarkupPoint> parse_markups(const std::string& text, const std::string& file_name) {
  const std::string name = folded(file_name);
  if (name.ends_with(".json")) return parse_markups_json(text, file_name);
  if (name.ends_with(".fcsv")) return parse_fcsv(text, file_name);
  throw ConfigError("not a file of points by its name", file_name,
                    "give markups of 3D Slicer: NAME.mrk.json or NAME.fcsv");
}

std::vector<MarkupPoint> read_markups(const std::filesystem::path& file) {
  return parse_markups(read_file(file), file.string());
}

Point point_labelled(const std::vector<MarkupPoint>& points, const std::string& label,
                     const std::string& file_name) {
  const MarkupPoint* found = nullptr;
  for (const MarkupPoint& point : points) {
    if (folded(point.label) != folded(label)) continue;
    if (found != nullptr)
      throw ConfigError(
          fmt::format("two points have the label \"{}\": {} and {}", plain(label), found->place, point.place),
          file_name, "rename or delete one of them, so that it is certain which is meant");
    found = &point;
  }
  if (found == nullptr)
    throw ConfigError(fmt::format("no point has the label \"{}\"; {}", plain(label), labels_of(points)),
                      file_name, "rename the point in 3D Slicer, or say which label it has");
  if (!found->p_S)
    throw ConfigError(fmt::format("the point \"{}\" was not placed", plain(label)), found->place,
                      "place it on the image in 3D Slicer and save the file again");
  return *found->p_S;
}

}  // namespace biopsy::planner
