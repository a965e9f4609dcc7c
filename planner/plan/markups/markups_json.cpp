#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "planner/plan/markups/markups_formats.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/text/sanitize_text.hpp"

namespace biopsy::planner {
namespace {

using Json = nlohmann::json;

// Of two equal names in an object one reader takes the first, another the last.
Json parse_without_repetition(const std::string& text, const std::string& file) {
  std::vector<std::set<std::string>> open;
  std::string twice;
  const auto watch = [&](int, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key && !open.back().insert(value.get<std::string>()).second)
      twice = value.get<std::string>();
    return true;
  };
  Json json = Json::parse(text, watch, false);
  if (json.is_discarded() || !json.is_object()) refuse_markups("not a JSON file, or a damaged one", file);
  if (!twice.empty()) refuse_markups(fmt::format("\"{:.40}\" is given twice", plain(twice)), file);
  return json;
}

// The text of an entry; `standard` where it is missing.
std::string text_at(const Json& object, const char* name, const char* standard, const std::string& place) {
  const auto found = object.find(name);
  if (found == object.end()) return standard;
  if (!found->is_string()) refuse_markups(fmt::format("\"{}\" is not a text", name), place);
  return found->get<std::string>();
}

// The list of objects of an entry; empty where it is missing.
const Json& objects_at(const Json& object, const char* name, const std::string& place) {
  static const Json kNone = Json::array();
  const auto found = object.find(name);
  if (found == object.end()) return kNone;
  if (!found->is_array()) refuse_markups(fmt::format("\"{}\" is not a list", name), place);
  for (const Json& item : *found)
    if (!item.is_object())
      refuse_markups(fmt::format("\"{}\" holds something that is no object", name), place);
  return *found;
}

// True: RAS. The schema makes LPS the standard.
bool is_ras(const Json& markup, const std::string& place) {
  const std::string frame = text_at(markup, "coordinateSystem", "LPS", place);
  if (frame != "LPS" && frame != "RAS")
    refuse_markups(fmt::format("the coordinate system \"{:.40}\" is neither LPS nor RAS", plain(frame)),
                   place);
  return frame == "RAS";
}

// "mm", or DICOM's coded entry for it.
void refuse_other_units(const Json& markup, const std::string& place) {
  const auto units = markup.find("coordinateUnits");
  if (units == markup.end() || *units == "mm") return;
  if (units->is_array() && units->size() == 3 && units->at(0) == "mm" && units->at(1) == "UCUM") return;
  throw ConfigError("the coordinates are not in mm", place,
                    "set 3D Slicer's unit of length to millimetres and save the markups again");
}

Point position_of(const Json& point, bool ras, const std::string& place) {
  const auto position = point.find("position");
  const bool three = position != point.end() && position->is_array() && position->size() == 3;
  Point p = Point::Zero();
  for (std::size_t axis = 0; three && axis < 3; ++axis) {
    const Json& coordinate = position->at(axis);
    // A number that is not finite is no number of JSON; one too large does not parse.
    if (!coordinate.is_number()) refuse_markups("a coordinate is not a number", place);
    p[static_cast<Eigen::Index>(axis)] = coordinate.get<double>();
  }
  if (!three) refuse_markups("\"position\" is not three numbers", place);
  return markup_position(p, ras, place);
}

bool is_placed(const Json& point, const std::string& place) {
  const std::string status = text_at(point, "positionStatus", "defined", place);
  if (status != "defined" && status != "preview" && status != "undefined")
    refuse_markups(fmt::format("the position status \"{:.40}\" is not known", plain(status)), place);
  return status == "defined";
}

}  // namespace

std::vector<MarkupPoint> parse_markups_json(const std::string& text, const std::string& file_name) {
  const Json json = parse_without_repetition(text, file_name);
  const std::string schema = text_at(json, "@schema", "", file_name);
  if (schema.find("/markups-schema-v1.") == std::string::npos)
    refuse_markups("no markups by its \"@schema\" (version 1 is read)", file_name);
  if (!json.contains("markups")) refuse_markups("\"markups\" is missing", file_name);
  std::vector<MarkupPoint> points;
  std::size_t markup_number = 0;
  for (const Json& markup : objects_at(json, "markups", file_name)) {
    const std::string in_markup = fmt::format("{}: markup {}", file_name, ++markup_number);
    if (!markup.contains("type")) refuse_markups("\"type\" is missing", in_markup);
    text_at(markup, "type", "", in_markup);
    const bool ras = is_ras(markup, in_markup);
    refuse_other_units(markup, in_markup);
    std::size_t point_number = 0;
    for (const Json& given : objects_at(markup, "controlPoints", in_markup)) {
      const std::string place = fmt::format("{}, control point {}", in_markup, ++point_number);
      MarkupPoint point{.label = text_at(given, "label", "", place), .p_S = std::nullopt, .place = place};
      if (is_placed(given, place)) point.p_S = position_of(given, ras, place);
      points.push_back(std::move(point));
    }
  }
  return points;
}

}  // namespace biopsy::planner
