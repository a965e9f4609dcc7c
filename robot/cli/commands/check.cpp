// biopsy check: the depth check on two images alone.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "robot/cli/command.hpp"
#include "robot/cli/commands/depth_images.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/common/text/ras_point.hpp"
#include "robot/procedure/case/tip_calibration.hpp"
#include "robot/report/plot/png.hpp"
#include "robot/report/procedure/labels.hpp"

namespace biopsy::robot {
namespace check_cli {

struct Options {
  DepthImageOptions images;
  std::string entry, axis;              // "R,A,S" in mm; the axis is a direction of any length
  std::optional<double> expected_mm;    // planned depth
  std::optional<double> tip_offset_mm;  // by hand, without a calibration
  double tip_offset_sigma_mm = 0.2;
  std::filesystem::path tip_calibration, public_key;
  std::filesystem::path out;  // empty: no files
};

void declare(CLI::App& app, Options& options) {
  add_depth_images(app, options.images);
  add(app, "--entry R,A,S", options.entry, "where depth is zero, mm")->required();
  add(app, "--axis R,A,S", options.axis, "direction of insertion, any length")->required();
  add(app, "--expected MM", options.expected_mm, "planned depth: accept only where the tip is there")
      ->check(in_range(0.0, 1000.0, "mm"));
  add(app, "--tip-calibration FILE", options.tip_calibration,
      "signed tip offset of this needle in this sequence, by `biopsy calibrate-tip`", "none");
  add(app, "--public-key PEM", options.public_key, "public key by which `--tip-calibration` is checked",
      "the one of `biopsy keys init`");
  add(app, "--tip-offset MM", options.tip_offset_mm,
      "how far the void ends beyond the real tip, by hand; without any, nothing is accepted")
      ->check(in_range(-20.0, 20.0, "mm"));
  add(app, "--tip-offset-sigma MM", options.tip_offset_sigma_mm,
      "how well it is known, one standard deviation", "0.2")
      ->check(in_range(0.01, 5.0, "mm"));
  add_out(app, options.out, "the result and two pictures")->default_str("no files");
}

nlohmann::ordered_json as_json(const DepthCheck& result, const std::vector<std::string>& warnings) {
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
  json["lateral_mm"] = json["lateral_sigma_mm"] = json["angle_deg"] = json["angle_sigma_deg"] = nullptr;
  if (result.tip_found) {
    json["lateral_mm"] = rounded(result.lateral_mm, 4);
    json["lateral_sigma_mm"] = rounded(result.lateral_sigma_mm, 4);
    json["angle_deg"] = rounded(result.angle_deg, 4);
    json["angle_sigma_deg"] = rounded(result.angle_sigma_deg, 4);
  }
  json["tip_offset_mm"] = json["tip_offset_sigma_mm"] = nullptr;
  if (result.tip_offset_known) {
    json["tip_offset_mm"] = result.tip_offset_mm;
    json["tip_offset_sigma_mm"] = result.tip_offset_sigma_mm;
  }
  json["shift_lps_mm"] = result.shift_mm;
  json["rotation_lps_deg"] = result.rotation_deg;
  json["registration_score"] = result.registration_score;
  json["contrast_to_noise"] = result.contrast_to_noise;
  json["warnings"] = warnings;
  return json;
}

std::string text_of(const DepthCheck& result) {
  const auto three = [](const auto& v) {
    return fmt::format("{}, {}, {}", fixed(v[0], 2), fixed(v[1], 2), fixed(v[2], 2));
  };
  std::string text =
      fmt::format("verdict   {}\nreason    {}\n", report::label(result.verdict), result.reason);
  if (result.tip_found)
    text += fmt::format(
        "depth     {}, standard deviation {}{}\n"
        "beside    {} from the planned axis, standard deviation {}\n"
        "angle     {} degrees to the planned axis, standard deviation {}\n",
        fixed(result.depth.value, 2, "mm"), fixed(result.sigma.value, 2, "mm"),
        result.tip_offset_known ? "" : "; of the void's end: no tip offset",
        fixed(result.lateral_mm, 2, "mm"), fixed(result.lateral_sigma_mm, 2, "mm"),
        fixed(result.angle_deg, 1), fixed(result.angle_sigma_deg, 1));
  return text + fmt::format(
                    "motion    shift {} mm; turn {} degrees (LPS)\n"
                    "match     {} after registration; contrast to noise {}\n",
                    three(result.shift_mm), three(result.rotation_deg), fixed(result.registration_score, 3),
                    fixed(result.contrast_to_noise, 1));
}

std::optional<TipOffset> offset_of(const Options& options) {
  if (options.tip_offset_mm && !options.tip_calibration.empty())
    throw ConfigError("a tip offset by hand and a calibration", "--tip-offset", "give one of them");
  if (!options.tip_calibration.empty())
    return read_tip_calibration(options.tip_calibration, options.public_key).offset;
  if (!options.tip_offset_mm) return std::nullopt;
  return TipOffset{"by hand", "by hand", Millimetres(*options.tip_offset_mm),
                   Millimetres(options.tip_offset_sigma_mm)};
}

std::vector<std::filesystem::path> inputs_of(const Options& options) {
  std::vector<std::filesystem::path> all = options.images.files();
  all.push_back(options.tip_calibration);
  return all;
}

Result run(const Options& options, const Context&) {
  const Point p_SE = parse_ras_point("--entry", options.entry);
  const Point axis_S = parse_ras_point("--axis", options.axis);
  const double length = axis_S.norm();
  if (length < 1e-6) throw ConfigError("has no length", "--axis", "give the insertion direction, e.g. 0,1,0");
  const DepthImages images = read_depth_images(options.images);
  if (!options.out.empty())
    make_output_folder(options.out, inputs_of(options), {"check.json", "before.png", "after.png"});
  ProgressLine line;
  line.show(-1.0, "registering the images and looking for the tip");
  imaging::DepthCheckSettings settings;
  if (options.expected_mm) settings.expected = Millimetres(*options.expected_mm);
  settings.tip_offset = offset_of(options);
  imaging::DepthCheckPictures pictures;
  const DepthCheck result =
      imaging::check_depth(images.before, images.after, p_SE, axis_S / length, settings, &pictures);
  const std::string json = as_json(result, images.warnings).dump(2) + "\n";
  std::string text = text_of(result) + warning_lines(images.warnings);
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
                       "--entry -4.396,33.092,51.854 --axis -0.936,0.036,-0.349 --tip-offset 0 --json"},
          .exit_codes = "0 for any verdict, 2 for unusable input",
          .outputs = {{"check.json", "[the result for programs](#checkjson)"},
                      {"before.png", "the path before insertion"},
                      {"after.png", "the path after insertion"}},
          .json = "the content of [check.json](#checkjson)",
          .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
