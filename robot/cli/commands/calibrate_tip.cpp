// biopsy calibrate-tip: how far a needle's void goes on beyond its tip, from images at a known depth.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "robot/cli/command.hpp"
#include "robot/cli/commands/depth_images.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/ed25519.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/common/text/ras_point.hpp"
#include "robot/procedure/case/tip_calibration.hpp"
#include "robot/security/key_files.hpp"

namespace biopsy::robot {
namespace calibrate_tip_cli {

namespace fs = std::filesystem;

constexpr const char* kFile = "tip_calibration.toml";

struct Options {
  DepthImageOptions images;
  fs::path add, key, public_key, out;
  std::string entry, axis, needle, sequence;
  double depth_mm = 0.0, depth_sigma_mm = 0.1;
};

void declare(CLI::App& app, Options& options) {
  add_depth_images(app, options.images);
  add(app, "--entry R,A,S", options.entry, "where depth is zero, mm")->required();
  add(app, "--axis R,A,S", options.axis, "direction of insertion, any length")->required();
  add(app, "--depth MM", options.depth_mm,
      "known depth of the tip: of a phantom, or the laser's after the first insertion of a session")
      ->required()
      ->check(in_range(0.0, 1000.0, "mm"));
  add(app, "--depth-sigma MM", options.depth_sigma_mm, "how well it is known, one standard deviation", "0.1")
      ->check(in_range(0.01, 5.0, "mm"));
  add(app, "--needle NAME", options.needle, "needle, as a case names it")->required();
  add(app, "--sequence NAME", options.sequence, "sequence of the images, as a case names it")->required();
  add(app, "--add FILE", options.add, "calibration to which this insertion is added", "none");
  add(app, "--key PEM", options.key, "private Ed25519 key that signs the calibration",
      "the one of `biopsy keys init`");
  add(app, "--public-key PEM", options.public_key, "its public key, by which `--add` is checked",
      "the one of `biopsy keys init`");
  add_out(app, options.out, "calibration and signature")->required();
}

// What a check must say of images by which others are judged: one needle, near the axis, whose void ends
// within them. The distance and the angle to the axis may be larger than a plan's: depth is along the axis,
// and 4 degrees shorten it by a quarter of a percent.
imaging::DepthCheckSettings calibrating(const Options& options) {
  imaging::DepthCheckSettings settings;
  settings.tip_offset = TipOffset{options.needle, options.sequence, Millimetres(0.0), Millimetres(0.01)};
  settings.depth_mm.limit = 2.0;  // known to 1 mm
  settings.lateral_mm = {4.0, 6.0};
  settings.angle_deg = {4.0, 8.0};
  return settings;
}

TipMeasurement measured(const Options& options, const DepthImages& images) {
  const Point p_SE = parse_ras_point("--entry", options.entry);
  const Point axis_S = parse_ras_point("--axis", options.axis);
  if (axis_S.norm() < 1e-6)
    throw ConfigError("has no length", "--axis", "give the insertion direction, e.g. 0,1,0");
  const DepthCheck check =
      imaging::check_depth(images.before, images.after, p_SE, axis_S.normalized(), calibrating(options));
  if (check.verdict != DepthVerdict::Accept)
    throw ConfigError("the end of the void cannot be read: " + check.reason, "--before, --after",
                      "check entry, axis and images, or calibrate in a uniform phantom: the void must lie "
                      "along the axis and end within the phantom");
  const double offset_mm = check.depth.value - options.depth_mm;
  if (std::abs(offset_mm) > kOffsetMost_mm)
    throw ConfigError(
        fmt::format("the void ends at {:.1f} mm, {:.1f} mm from the tip", check.depth.value, offset_mm),
        "--depth", "check the depth, and that the entry is where it is zero");
  const std::string date = images.after.front().identity.date;
  return {offset_mm, std::hypot(check.sigma.value, options.depth_sigma_mm),
          fmt::format("{}{}void's end at {:.2f} mm, tip at {:.2f} mm", date, date.empty() ? "" : ", ",
                      check.depth.value, options.depth_mm)};
}

nlohmann::ordered_json as_json(const TipCalibration& calibration, const std::vector<std::string>& warnings) {
  const TipOffset& offset = calibration.offset;
  return {{"needle", offset.needle},
          {"sequence", offset.sequence},
          {"tip_offset_mm", rounded(offset.value.value, 4)},
          {"tip_offset_sigma_mm", rounded(offset.sigma.value, 4)},
          {"measurements", calibration.measurements.size()},
          {"warnings", warnings}};
}

Result run(const Options& options, const Context&) {
  if (options.sequence == kSimulatedSequence)
    throw ConfigError("is the name of the built-in scanner's images", "--sequence", "name the real sequence");
  TipCalibration calibration;
  if (!options.add.empty()) {
    calibration = read_tip_calibration(options.add, options.public_key);
    if (calibration.offset.needle != options.needle || calibration.offset.sequence != options.sequence)
      throw ConfigError("is the calibration of another needle or sequence", options.add.string(),
                        "add to the one of this needle in this sequence, or leave --add out");
  }
  const SigningKey key(
      options.key.empty()
          ? security::signing_files(security::default_folder(), security::Signer::Commissioning).private_key
          : options.key);
  const DepthImages images = read_depth_images(options.images);
  calibration.measurements.push_back(measured(options, images));
  calibration.offset = tip_offset_of(options.needle, options.sequence, calibration.measurements);
  const std::string text = tip_calibration_toml(calibration);
  const fs::path file = options.out / kFile;
  std::vector<fs::path> inputs = options.images.files();
  inputs.insert(inputs.end(), {options.add, options.key});
  make_output_folder(options.out, inputs, {kFile, signature_of(kFile).string()});
  // The old signature first: a signature never lies beside a calibration it does not belong to.
  std::error_code absent;
  fs::remove(signature_of(file), absent);
  atomic_write(file, text);
  atomic_write(signature_of(file), std::string(view(key.sign(text))));
  const TipOffset& offset = calibration.offset;
  return {
      .text = fmt::format("tip offset  {}, standard deviation {} of the next insertion; {} measurement{}\n"
                          "written     {}\n",
                          fixed(offset.value.value, 2, "mm"), fixed(offset.sigma.value, 2, "mm"),
                          calibration.measurements.size(), calibration.measurements.size() == 1 ? "" : "s",
                          file.string()) +
              warning_lines(images.warnings),
      .json = as_json(calibration, images.warnings).dump(2) + "\n"};
}

}  // namespace calibrate_tip_cli

Command calibrate_tip_command() {
  using namespace calibrate_tip_cli;
  return {
      .name = "calibrate-tip",
      .summary = "how far a needle's void goes on beyond its tip",
      .description =
          "Reads where the void ends in images of a needle at a known depth and writes the signed "
          "tip offset of this needle in this sequence: "
          "[depth check](../explanation/depth-check.md#calibration-of-the-tip). Without one no "
          "confirmation image is accepted.",
      .long_examples = {"biopsy calibrate-tip --before scans/before --after scans/after --entry 9.2,-22,20 "
                        "--axis 0,0,1 --depth 43 --needle titanium-18G --sequence GRE-TE5 --out calibration"},
      .exit_codes = "0, 2 for unusable input",
      .outputs = {{"tip_calibration.toml", "offset and measurements"},
                  {"tip_calibration.sig", "its signature"}},
      .json =
          "`needle`, `sequence`, `tip_offset_mm`, `tip_offset_sigma_mm`, `measurements` (their number), "
          "`warnings`",
      .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
