#include "robot/procedure/images/confirmation_image.hpp"

#include <fmt/format.h>

#include <cmath>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "robot/procedure/images/slice_geometry.hpp"
#include "sim/plant/seeded_noise.hpp"
#include "sim/scanner/dicom_series.hpp"
#include "sim/scanner/scanner.hpp"

namespace biopsy::robot {
namespace {

constexpr std::uint64_t kMotionStream = 0x6d6f7665, kRepeatStream = 1'000'003;

// The patient's position at image number `image`: uniform within the case's bounds, drawn from the seed.
sim::PatientMotion motion_at(const Case& given, const Point& about, std::uint64_t image) {
  const auto draw = [&](std::uint64_t axis) {
    return 2.0 * sim::uniform(given.seed ^ kMotionStream, 6 * image + axis) - 1.0;
  };
  const double scale = 1.0 / std::sqrt(3.0);  // the bound holds for the length, not for each axis
  sim::PatientMotion motion;
  motion.about = about;
  motion.shift_mm = given.rehearsal.motion_mm * scale * Eigen::Vector3d(draw(0), draw(1), draw(2));
  motion.rotation_deg = given.rehearsal.motion_deg * scale * Eigen::Vector3d(draw(3), draw(4), draw(5));
  return motion;
}

}  // namespace

void ConfirmationImages::take(std::size_t step, Millimetres tip, report::StepResult& result) {
  const std::size_t repeat = repeats_[step]++;
  const std::string name =
      fmt::format("images/stage-{}{}", step + 1, repeat == 0 ? "" : fmt::format("-repeat-{}", repeat));
  sim::ScanSettings settings;
  const Point p_SE = plan_.X_SR.translation();
  const Direction axis_S = plan_.X_SR.linear().col(2);
  settings.needle = sim::NeedleArtefact{.p_SE = p_SE, .axis_S = axis_S, .tip_depth = tip};
  settings.motion = motion_at(prepared_.given, p_SE, step + kRepeatStream * repeat);
  settings.snr = prepared_.given.rehearsal.snr;
  settings.seed = prepared_.given.seed + 1000 * (step + 1) + kRepeatStream * repeat;
  Volume sent = sim::scan(prepared_.image, settings);
  sent.identity.series_uid.clear();  // a new series; the writer names it by its content
  sent.identity.description = fmt::format("confirmation, stage {} (simulated)", step + 1);
  sim::write_dicom_series(sent, folder_ / name);
  const Volume after = imaging::read_volume(folder_ / name);
  imaging::DepthCheckSettings check;
  check.expected = plan_.steps[step].depth;
  check.tip_offset = plan_.tip_offset;
  imaging::DepthCheckPictures pictures;
  result.check = imaging::check_depth(prepared_.image, after, p_SE, axis_S, check, &pictures);
  result.image_path = name;
  result.before = pictures.before.picture;
  result.after = pictures.after.picture;
  if (pictures.after.picture.width > 0) result.geometry = geometry_of(pictures.after);
}

}  // namespace biopsy::robot
