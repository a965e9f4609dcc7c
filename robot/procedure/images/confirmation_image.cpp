#include "robot/procedure/images/confirmation_image.hpp"

#include <fmt/format.h>

#include <cmath>
#include <thread>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "robot/common/config_error.hpp"
#include "robot/procedure/images/image_objection.hpp"
#include "robot/procedure/images/patient_motion.hpp"
#include "robot/procedure/images/slice_geometry.hpp"
#include "sim/plant/seeded_noise.hpp"
#include "sim/scanner/dicom_series.hpp"
#include "sim/scanner/scanner.hpp"
#include "sim/scanner/simulated_mark.hpp"

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

// `incomplete`: what came nevertheless; empty: nothing.
std::string nothing_within(const ImageSource& source, const std::string& incomplete) {
  const double seconds = std::chrono::duration<double>(source.patience).count();
  if (incomplete.empty())
    return fmt::format("no new image arrived in {} within {:.0f} s", source.folder.string(), seconds);
  return fmt::format("no image was complete in {} within {:.0f} s, only: {}", source.folder.string(), seconds,
                     incomplete);
}

}  // namespace

ConfirmationImages::ConfirmationImages(const PreparedCase& prepared, const Plan& plan,
                                       std::filesystem::path folder)
    : prepared_(prepared), plan_(plan), folder_(std::move(folder)) {
  const ImageSource& source = prepared.given.images;
  if (!source.folder.empty()) watched_.emplace(source.folder, source.quiet, source.planes);
}

void ConfirmationImages::take(std::size_t step, Millimetres tip, std::chrono::milliseconds held,
                              report::StepResult& result) {
  if (watched_) {
    receive(step, held, result);
  } else if (prepared_.given.rehearsal.accept_unseen) {
    result.check = DepthCheck{};
    result.check->verdict = DepthVerdict::Accept;
    result.check->reason = "accepted unseen";
  } else {
    simulate(step, tip, result);
  }
}

void ConfirmationImages::simulate(std::size_t step, Millimetres tip, report::StepResult& result) {
  const std::size_t repeat = repeats_[step]++;
  const std::string name =
      fmt::format("images/stage-{}{}", step + 1, repeat == 0 ? "" : fmt::format("-repeat-{}", repeat));
  sim::ScanSettings settings;
  const Point p_SE = plan_.X_SR.translation();
  const Direction axis_S = plan_.X_SR.linear().col(2);
  const Rehearsal& rehearsal = prepared_.given.rehearsal;
  if (rehearsal.needle) {
    settings.body = rehearsal.needle;
    settings.body->p_ST = p_SE + tip.value * axis_S;
    settings.body->p_SE = settings.body->p_ST - axis_S;
  } else {
    // The painted void goes on beyond the tip as the plan's calibration says, so that a case with a real
    // needle's calibration can be rehearsed.
    const Millimetres beyond = plan_.tip_offset ? plan_.tip_offset->value : Millimetres(0.0);
    settings.needle = sim::NeedleArtefact{.p_SE = p_SE, .axis_S = axis_S, .tip_depth = tip + beyond};
  }
  settings.sequence = rehearsal.sequence;
  settings.drift = rehearsal.coil_shading;
  settings.ghost = rehearsal.ghost, settings.ghost_shift_voxels = rehearsal.ghost_shift_voxels;
  settings.motion = motion_at(prepared_.given, p_SE, step + kRepeatStream * repeat);
  settings.snr = rehearsal.snr;
  settings.seed = prepared_.given.seed + 1000 * (step + 1) + kRepeatStream * repeat;
  Volume sent = sim::scan(prepared_.image, settings);
  sim::mark_simulated(sent);
  sent.identity.description = fmt::format("confirmation, stage {} (simulated)", step + 1);
  sim::write_dicom_series(sent, folder_ / name);
  const Volume seen = imaging::read_volume(folder_ / name);
  check(step, std::span(&seen, 1), result);
  result.image_path = name;
}

// An image of which it is not certain that it shows this needle in this patient confirms nothing.
void ConfirmationImages::receive(std::size_t step, std::chrono::milliseconds held,
                                 report::StepResult& result) {
  using std::chrono::steady_clock, std::chrono::system_clock;
  const ImageSource& source = prepared_.given.images;
  const auto unsure = [&](const std::string& reason) {
    result.check = DepthCheck{};
    result.check->reason = reason;
  };
  // Of an image that was judged before in this step: where no other comes, its reason is still the reason.
  const std::string judged = result.check && !result.image_path.empty() ? result.check->reason : "";
  const auto arrived = system_clock::now() - held;
  const auto until = steady_clock::now() + source.patience;
  imaging::IncomingImage image;
  while ((image = watched_->poll(steady_clock::now())).empty() && steady_clock::now() < until && !cancelled_)
    std::this_thread::sleep_for(std::min(source.quiet / 4, std::chrono::milliseconds(100)));
  if (cancelled_) return unsure("the wait for an image was ended");
  if (image.empty())
    return unsure(nothing_within(source, watched_->incomplete()) +
                  (judged.empty() ? "" : "; of the image before: " + judged));
  result.image_path = image.front().files.front().string();
  const ExpectedImage expected{prepared_.image.identity, arrived, system_clock::now(), last_acquired_,
                               source.confirmed_by};
  for (const imaging::IncomingSeries& series : image)
    if (const std::string objection = image_objection(series, expected); !objection.empty())
      return unsure(objection);
  for (const imaging::IncomingSeries& series : image)
    if (series.acquired)
      last_acquired_ = std::max(last_acquired_.value_or(*series.acquired), *series.acquired);
  try {
    check(step, imaging::read_incoming_stacks(image), result);
  } catch (const ConfigError& refusal) {
    unsure(refusal.what());
  }
}

void ConfirmationImages::check(std::size_t step, std::span<const Volume> after,
                               report::StepResult& result) const {
  imaging::DepthCheckSettings settings;
  settings.expected = plan_.steps[step].depth;
  // The void that the simulated scanner paints tells nothing about a real needle's.
  const bool calibrated = plan_.tip_offset && !(watched_ && plan_.tip_offset->sequence == kSimulatedSequence);
  if (calibrated) settings.tip_offset = plan_.tip_offset;
  imaging::DepthCheckPictures pictures;
  result.check = imaging::check_depth(prepared_.image, after, plan_.X_SR.translation(),
                                      plan_.X_SR.linear().col(2), settings, &pictures);
  judge_patient_motion(*result.check, plan_.X_SR.linear().col(2), plan_.steps[step].depth,
                       settings.registration_min);
  result.before = pictures.before.picture;
  result.after = pictures.after.picture;
  if (pictures.after.picture.width > 0) result.geometry = geometry_of(pictures.after);
}

}  // namespace biopsy::robot
