// biopsy check: the depth check on two images alone.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "robot/cli/commands.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/whole_file.hpp"
#include "robot/common/progress.hpp"
#include "robot/common/typed_point.hpp"
#include "robot/report/plot/png.hpp"
#include "robot/report/procedure/labels.hpp"

namespace biopsy::robot {
namespace {

nlohmann::ordered_json as_json(const DepthCheck& result) {
  nlohmann::ordered_json json;
  json["verdict"] = std::string(report::label(result.verdict));
  json["reason"] = result.reason;
  json["tip_found"] = result.tip_found;
  json["image_depth_mm"] = nullptr;
  json["image_depth_sigma_mm"] = nullptr;
  if (result.tip_found) {
    json["image_depth_mm"] = std::round(result.depth.value * 1e4) / 1e4;
    json["image_depth_sigma_mm"] = std::round(result.sigma.value * 1e4) / 1e4;
  }
  json["shift_lps_mm"] = result.shift_mm;
  json["rotation_lps_deg"] = result.rotation_deg;
  json["registration_score"] = result.registration_score;
  json["contrast_to_noise"] = result.contrast_to_noise;
  return json;
}

void check_patients(const Volume& before, const Volume& after) {
  const std::string &a = before.identity.patient_id, &b = after.identity.patient_id;
  if (!a.empty() && !b.empty() && a != b)
    throw ConfigError(fmt::format("the images show two patients, \"{}\" and \"{}\"", a, b),
                      "--before, --after", "give two images of one patient");
}

}  // namespace

int check(const CheckOptions& options) {
  ProgressLine line;
  const Point p_SE = typed_point("--entry", options.entry);
  const Point axis_S = typed_point("--axis", options.axis);
  const double length = axis_S.norm();
  if (length < 1e-6) throw ConfigError("has no length", "--axis", "give the insertion direction, e.g. 0,1,0");
  const Volume before = imaging::read_volume(options.before, options.before_series);
  const Volume after = imaging::read_volume(options.after, options.after_series);
  check_patients(before, after);
  line.show(-1.0, "registering the images and looking for the tip");
  imaging::DepthCheckSettings settings;
  if (options.expected_mm) settings.expected = Millimetres(*options.expected_mm);
  settings.tip_offset = Millimetres(options.tip_offset_mm);
  imaging::DepthCheckPictures pictures;
  const DepthCheck result = imaging::check_depth(before, after, p_SE, axis_S / length, settings, &pictures);
  const std::string json = as_json(result).dump(2) + "\n";
  if (!options.out.empty()) {
    report::save_png(pictures.before.picture, options.out / "before.png");
    report::save_png(pictures.after.picture, options.out / "after.png");
    report::atomic_write(options.out / "check.json", json);
  }
  if (options.json) {
    fmt::print("{}", json);
    return 0;
  }
  fmt::print("verdict   {}\nreason    {}\n", report::label(result.verdict), result.reason);
  if (result.tip_found)
    fmt::print("depth     {:.2f} mm, standard deviation {:.2f} mm\n", result.depth.value, result.sigma.value);
  fmt::print("motion    shift {:.2f}, {:.2f}, {:.2f} mm; turn {:.2f}, {:.2f}, {:.2f} degrees (LPS)\n",
             result.shift_mm[0], result.shift_mm[1], result.shift_mm[2], result.rotation_deg[0],
             result.rotation_deg[1], result.rotation_deg[2]);
  fmt::print("match     {:.3f} after registration; contrast to noise {:.1f}\n", result.registration_score,
             result.contrast_to_noise);
  if (!options.out.empty()) fmt::print("pictures  {}\n", options.out.string());
  return 0;
}

}  // namespace biopsy::robot
