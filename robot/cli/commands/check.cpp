// biopsy check: the depth check on two images alone.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/common/text/ras_point.hpp"
#include "robot/report/plot/png.hpp"
#include "robot/report/procedure/labels.hpp"

namespace biopsy::robot {
namespace check_cli {

struct Options {
  std::filesystem::path before, after;
  std::string before_series, after_series;
  std::string entry, axis;            // "R,A,S" in mm; the axis is a direction of any length
  std::optional<double> expected_mm;  // planned depth
  double tip_offset_mm = 0.0;
  std::filesystem::path out;  // empty: no files
};

void declare(CLI::App& app, Options& options) {
  add(app, "--before PATH", options.before, "image without the needle")->required();
  add(app, "--after PATH", options.after, "image with the needle")->required();
  add(app, "--before-series UID", options.before_series, "series UID, where that folder holds several");
  add(app, "--after-series UID", options.after_series, "series UID, where that folder holds several");
  add(app, "--entry R,A,S", options.entry, "where depth is zero, mm")->required();
  add(app, "--axis R,A,S", options.axis, "direction of insertion, any length")->required();
  add(app, "--expected MM", options.expected_mm, "planned depth: accept only where the tip is there")
      ->check(in_range(0.0, 1000.0, "mm"));
  add(app, "--tip-offset MM", options.tip_offset_mm, "how far the void ends beyond the real tip", "0")
      ->check(in_range(-20.0, 20.0, "mm"));
  add_out(app, options.out, "the result and two pictures")->default_str("no files");
}

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
  // A rehearsal's image of a patient names itself: it is of the planning image's patient, simulated.
  const auto patient = [](const Volume& volume) {
    const std::string& id = volume.identity.patient_id;
    return id.starts_with("SIMULATED-") ? id.substr(10) : id;
  };
  const std::string a = patient(before), b = patient(after);
  if (!a.empty() && !b.empty() && a != b)
    throw ConfigError(fmt::format("the images show two patients, \"{}\" and \"{}\"", a, b),
                      "--before, --after", "give two images of one patient");
}

std::string text_of(const DepthCheck& result) {
  const auto three = [](const auto& v) {
    return fmt::format("{}, {}, {}", fixed(v[0], 2), fixed(v[1], 2), fixed(v[2], 2));
  };
  std::string text =
      fmt::format("verdict   {}\nreason    {}\n", report::label(result.verdict), result.reason);
  if (result.tip_found)
    text += fmt::format("depth     {}, standard deviation {}\n", fixed(result.depth.value, 2, "mm"),
                        fixed(result.sigma.value, 2, "mm"));
  return text + fmt::format(
                    "motion    shift {} mm; turn {} degrees (LPS)\n"
                    "match     {} after registration; contrast to noise {}\n",
                    three(result.shift_mm), three(result.rotation_deg), fixed(result.registration_score, 3),
                    fixed(result.contrast_to_noise, 1));
}

Result run(const Options& options, const Context&) {
  const Point p_SE = parse_ras_point("--entry", options.entry);
  const Point axis_S = parse_ras_point("--axis", options.axis);
  const double length = axis_S.norm();
  if (length < 1e-6) throw ConfigError("has no length", "--axis", "give the insertion direction, e.g. 0,1,0");
  const Volume before = imaging::read_volume(options.before, options.before_series);
  const Volume after = imaging::read_volume(options.after, options.after_series);
  check_patients(before, after);
  if (!options.out.empty())
    make_output_folder(options.out, {options.before, options.after},
                       {"check.json", "before.png", "after.png"});
  ProgressLine line;
  line.show(-1.0, "registering the images and looking for the tip");
  imaging::DepthCheckSettings settings;
  if (options.expected_mm) settings.expected = Millimetres(*options.expected_mm);
  settings.tip_offset = Millimetres(options.tip_offset_mm);
  imaging::DepthCheckPictures pictures;
  const DepthCheck result = imaging::check_depth(before, after, p_SE, axis_S / length, settings, &pictures);
  const std::string json = as_json(result).dump(2) + "\n";
  std::string text = text_of(result);
  if (!options.out.empty()) {
    report::save_png(pictures.before.picture, options.out / "before.png");
    report::save_png(pictures.after.picture, options.out / "after.png");
    atomic_write(options.out / "check.json", json);
    text += fmt::format("pictures  {}\n", options.out.string());
  }
  return {.text = text, .json = json};
}

}  // namespace check_cli

Command check_command() {
  using namespace check_cli;
  return {.name = "check",
          .summary = "depth of the needle from two images, before and after insertion",
          .description =
              "Registers the images, looks for what changed along the expected path and says "
              "accept, reject or unsure: [depth check](../explanation/depth-check.md). Two images of two "
              "patients "
              "are refused.",
          .examples = {"biopsy check --before out/gap/planning --after out/gap/images/stage-1 "
                       "--entry -4.396,33.092,51.854 --axis -0.936,0.036,-0.349 --json"},
          .exit_codes = "0 for any verdict, 2 for unusable input",
          .outputs = {{"check.json", "[the result for programs](#checkjson)"},
                      {"before.png", "the path before insertion"},
                      {"after.png", "the path after insertion"}},
          .json = "the content of [check.json](#checkjson)",
          .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
