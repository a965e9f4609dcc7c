#include "robot/procedure/case/case.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "planner/plan/markups/markups_file.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/toml_reader.hpp"
#include "robot/procedure/case/controller_file.hpp"
#include "robot/procedure/case/tip_calibration.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

constexpr double kFar_mm = 2000.0;  // no scanner's field is wider

fs::path beside(const fs::path& case_file, const std::string& path) {
  return fs::path(path).is_absolute() ? fs::path(path) : case_file.parent_path() / path;
}

Point ras_point(TomlTable& table, std::string_view name) {
  const std::vector<double> ras = table.numbers(name, -kFar_mm, kFar_mm);
  if (ras.size() != 3)
    throw ConfigError(fmt::format("`{}` has {} numbers", name, ras.size()), table.where(),
                      "give R, A, S in mm");
  return lps_from_ras({ras[0], ras[1], ras[2]});
}

void read_image(TomlTable table, const fs::path& file, Case& out) {
  out.phantom = table.has("phantom");
  if (out.phantom) {
    if (table.text("phantom") != "paper")
      throw ConfigError("unknown phantom", table.where(), "the built-in phantom is \"paper\"");
  } else {
    out.image = beside(file, table.text("path"));
  }
  if (table.has("series")) out.series_uid = table.text("series");
  if (table.has("labels")) out.labels = beside(file, table.text("labels"));
  for (TomlTable& label : table.tables("label"))
    out.label_names[static_cast<int>(label.number("value", -1e6, 1e6))] = label.text("name");
}

// The points of a file that says its frame itself, instead of numbers.
void read_markups_entry(TomlTable& table, const fs::path& file, Case& out) {
  for (const char* name : {"entry_label", "target_label"})
    if (table.has(name) && !table.has("markups"))
      table.refuse(name, "needs `markups`", "name the file of points too, or remove it");
  if (!table.has("markups")) return;
  for (const char* name : {"entry_ras_mm", "target_ras_mm", "depth_mm"})
    if (table.has(name)) table.refuse(name, "does not go with `markups`", "keep one of them");
  if (out.phantom) table.refuse("markups", "needs an image", "give the image's path instead of the phantom");
  take_markups(beside(file, table.text("markups")),
               table.has("entry_label") ? table.text("entry_label") : "entry",
               table.has("target_label") ? table.text("target_label") : "target", out);
}

void read_target(TomlTable table, const fs::path& file, Case& out) {
  read_markups_entry(table, file, out);
  if (table.has("entry_ras_mm")) out.p_SE = ras_point(table, "entry_ras_mm");
  if (table.has("target_ras_mm")) out.p_ST = ras_point(table, "target_ras_mm");
  if (table.has("depth_mm")) out.depth = Millimetres(table.number("depth_mm", 0.0, 100.0));
  if (out.depth && !out.phantom)
    throw ConfigError("`depth_mm` needs the phantom, whose needle axis is given", table.where(),
                      "give entry_ras_mm and target_ras_mm");
  if (!out.depth && !(out.p_SE && out.p_ST))
    throw ConfigError("no target", table.where(),
                      "give entry_ras_mm and target_ras_mm, or markups, or depth_mm with the phantom");
}

void read_robot(TomlTable table, const fs::path& file, Case& out) {
  if (table.has("weight_g")) out.weight = Grams(table.number("weight_g", 0.0, 1000.0));
  if (table.has("fiducials")) out.fiducials = beside(file, table.text("fiducials"));
  if (table.has("transform_ras")) out.transform = table.numbers("transform_ras", -kFar_mm, kFar_mm);
  if (out.transform && (out.transform->size() != 16 || !out.fiducials.empty()))
    throw ConfigError("`transform_ras` needs 16 numbers and no `fiducials` beside it", table.where(),
                      "give the 4 x 4 matrix row by row, or the fiducial file, not both");
}

void read_plan(TomlTable table, Case& out) {
  if (table.has("automatic_stages"))
    out.staging = table.flag("automatic_stages") ? planner::Staging::Automatic : planner::Staging::AsGiven;
  if (table.has("waypoints_mm"))
    for (const double depth : table.numbers("waypoints_mm", 0.0, 100.0)) out.waypoints.emplace_back(depth);
  if (table.has("speed_mm_s")) out.pace.speed = MillimetresPerSecond(table.number("speed_mm_s", 0.05, 20.0));
  if (table.has("crossing_mm_s"))
    out.pace.crossing = MillimetresPerSecond(table.number("crossing_mm_s", 0.05, 20.0));
  if (table.has("dwell_s")) out.pace.dwell = Seconds(table.number("dwell_s", 0.1, 30.0));
  for (TomlTable& layer : table.tables("layer"))
    out.layers.push_back({layer.text("name"), Millimetres(layer.number("from_mm", 0.0, 1000.0)),
                          Millimetres(layer.number("to_mm", 0.0, 1000.0))});
  if (!out.layers.empty()) planner::check_layers(out.layers, table.where());
}

// Needle and sequence of the confirmation images, and the calibration that holds for them.
std::optional<TipOffset> read_needle(TomlTable table, const fs::path& file) {
  const std::string needle = table.text("name"), sequence = table.text("sequence");
  if (!table.has("tip_calibration")) return std::nullopt;
  const TipOffset offset = read_tip_calibration(beside(file, table.text("tip_calibration"))).offset;
  if (offset.needle != needle || offset.sequence != sequence)
    throw ConfigError(fmt::format("the calibration is of needle \"{}\" in sequence \"{}\", the case asks for "
                                  "\"{}\" in \"{}\"",
                                  offset.needle, offset.sequence, needle, sequence),
                      table.where(), "calibrate this needle with this sequence: biopsy calibrate-tip");
  return offset;
}

Case case_of(TomlTable& root, const fs::path& file) {
  Case out = blank_case();
  out.title = root.has("title") ? root.text("title") : file.stem().string();
  read_image(root.table("image"), file, out);
  read_target(root.table("target"), file, out);
  if (root.has("robot")) read_robot(root.table("robot"), file, out);
  if (root.has("plan")) read_plan(root.table("plan"), out);
  if (root.has("controller")) out.gains = read_controller(root.table("controller"));
  if (root.has("rehearsal")) read_rehearsal(root.table("rehearsal"), file, out.rehearsal);
  if (root.has("needle"))
    out.tip_offset = read_needle(root.table("needle"), file);
  else if (out.rehearsal.needle)
    out.tip_offset.reset();  // the calibration that comes with the program is of the painted void
  if (root.has("seed")) out.seed = static_cast<std::uint64_t>(root.number("seed", 0.0, 9e15));
  if (!out.layers.empty() && !out.labels.empty())
    throw ConfigError("both a table of layers and a label map", file.string(), "keep one of them");
  return out;
}

}  // namespace

std::vector<std::string> built_in_cases() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(data_folder() / "robot/procedure/cases"))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<fs::path> files_of(const Case& given) {
  return {given.image,   given.labels,          given.fiducials,
          given.markups, given.rehearsal.model, given.rehearsal.tissues};
}

bool has_points(const Case& given) {
  return given.phantom || (given.p_SE && given.p_ST);
}

void take_markups(const fs::path& file, const std::string& entry_label, const std::string& target_label,
                  Case& out) {
  const std::vector<planner::MarkupPoint> points = planner::read_markups(file);
  out.p_SE = planner::point_labelled(points, entry_label, file.string());
  out.p_ST = planner::point_labelled(points, target_label, file.string());
  out.markups = file;
}

Case blank_case() {
  Case out;
  out.rehearsal.model = data_folder() / "sim/models/calibrated.toml";
  out.rehearsal.tissues = data_folder() / "sim/models/tissues.toml";
  out.tip_offset = read_tip_calibration(data_folder() / "sim/models/tip_calibration.toml").offset;
  return out;
}

Case read_case(const std::string& name_or_path) {
  fs::path file = name_or_path;
  const fs::path built_in = data_folder() / "robot/procedure/cases" / (name_or_path + ".toml");
  if (!fs::exists(file) && !file.has_parent_path() && fs::exists(built_in)) file = built_in;
  if (!fs::exists(file))
    throw ConfigError("no such case", name_or_path,
                      fmt::format("give a case file, or one of: {}", fmt::join(built_in_cases(), ", ")));
  return read_toml(file, [&](TomlTable& root) { return case_of(root, file); });
}

}  // namespace biopsy::robot
