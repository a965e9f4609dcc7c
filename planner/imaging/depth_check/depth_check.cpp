#include "planner/imaging/depth_check/depth_check.hpp"

#include <algorithm>
#include <cmath>

#include "planner/imaging/depth_check/depth_verdict.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::imaging {
namespace {

constexpr double kBehind_mm = 30.0;  // of the shaft behind the entry that is looked at
constexpr double kBeside_mm = 30.0;  // of tissue about the path that is registered

bool is_empty(const Volume& volume) {
  return volume.voxels.empty() || volume.voxels.size() != volume.grid.voxel_count();
}

bool shows(const Volume& volume, const Point& p_S) {
  return !std::isnan(Sampler(volume).at(p_S));
}

// Path from the entry as far as the after image goes; -1 where it shows none of it.
double path_end(std::span<const Volume> after, const NeedleFrame& frame, double depth_max) {
  double end = -1.0;
  for (const Volume& stack : after) {
    const Sampler sampler(stack);
    for (double t = 0.0; t <= depth_max; t += 0.5)
      if (!std::isnan(sampler.at(frame.point(t, 0, 0)))) end = std::max(end, t);
  }
  return end;
}

void refuse_bad(const Volume& before, std::span<const Volume> after, const NeedleFrame& frame) {
  const auto where = "depth check";
  if (is_empty(before) || std::any_of(after.begin(), after.end(), is_empty))
    throw ConfigError("an image has no voxels", where, "give two volumes that were read without complaint");
  const bool shown =
      std::any_of(after.begin(), after.end(), [&](const Volume& stack) { return shows(stack, frame.p_SE); });
  if (!shows(before, frame.p_SE) && !shown)
    throw ConfigError("the entry lies outside both images", where,
                      "check that entry and images are in one scanner frame (R,A,S or L,P,S mixed up?)");
}

// The stack that shows most of the path, for axes and pictures.
const Volume& widest_view(std::span<const Volume> after, const Point& p_SE, const Direction& axis_S) {
  const Volume* best = &after.front();
  int most = -1;
  for (const Volume& stack : after) {
    int shown = 0;
    for (double t = -20.0; t <= 60.0 && !is_empty(stack); t += 1.0) shown += shows(stack, p_SE + t * axis_S);
    if (shown > most) most = shown, best = &stack;
  }
  return *best;
}

void mark(Picture& picture, const Eigen::Vector2d& tip_px) {
  const auto dot = [&](double x, double y) {
    const auto column = static_cast<int>(std::lround(x)), row = static_cast<int>(std::lround(y));
    if (column < 0 || row < 0 || column >= picture.width || row >= picture.height) return;
    const auto at = 3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(picture.width) +
                         static_cast<std::size_t>(column));
    picture.rgb[at] = 255, picture.rgb[at + 1] = 210, picture.rgb[at + 2] = 0;
  };
  for (int n = 6; n <= 14; ++n)  // four strokes that leave the tip itself in view
    dot(tip_px.x() - n, tip_px.y()), dot(tip_px.x() + n, tip_px.y()), dot(tip_px.x(), tip_px.y() - n),
        dot(tip_px.x(), tip_px.y() + n);
}

void draw(const Volume& before, const Volume& after, const RegistrationResult& motion,
          const NeedleFrame& frame, double along_mm, bool tip_found, const TipFinding& tip,
          DepthCheckPictures& pictures) {
  constexpr int kSize_px = 512;
  const double extent = std::clamp(2.0 * along_mm + 20.0, 40.0, 160.0);
  pictures.after = slice_through_needle(after, frame.p_SE, frame.along, Millimetres(extent), kSize_px);
  pictures.before = pictures.after;
  const auto values = values_in_plane(before, pictures.before, motion.X_after_before.inverse());
  // The same tissue in the same grey: the after image's window, taken back through the change of brightness.
  const GreyWindow& window = pictures.after.window;
  if (motion.gain[0] > 0.05)
    pictures.before.window = {(window.black - motion.bias[0]) / motion.gain[0],
                              (window.white - motion.bias[0]) / motion.gain[0]};
  else
    pictures.before.window = window_of(values);
  paint(values, pictures.before.window, pictures.before.picture);
  pictures.tip_px = pictures.after.pixel(tip.depth_mm, tip.beside_mm.value.x());
  if (tip_found) mark(pictures.after.picture, pictures.tip_px);
}

void write_placement(const NeedlePlacement& read, DepthCheck& check) {
  check.depth = Millimetres(read.depth_mm), check.sigma = Millimetres(read.depth_sigma_mm);
  check.lateral_mm = read.lateral_mm, check.lateral_sigma_mm = read.lateral_sigma_mm;
  check.angle_deg = read.angle_deg, check.angle_sigma_deg = read.angle_sigma_deg;
}

}  // namespace

DepthReading read_depth(const Volume& before, std::span<const Volume> after, const NeedleFrame& frame,
                        Millimetres depth_max) {
  const double end = std::max(path_end(after, frame, depth_max.value), 0.0);
  Box box{frame.p_SE, frame.p_SE};
  box.include(frame.point(-kBehind_mm, 0, 0), kBeside_mm);
  box.include(frame.point(std::min(end, 60.0), 0, 0), kBeside_mm);
  RegistrationSettings registration{box, frame.p_SE, NeedleMask{frame, -1e3, depth_max.value, 7.0}};
  const RegistrationResult motion = register_rigid(before, after, registration);
  CorridorSettings path;
  path.from_mm = -kBehind_mm;
  path.to_mm = end;
  // All that is computed by voxel of the after image is then as large as the path's surroundings.
  box.include(frame.point(end, 0, 0), kBeside_mm);
  std::vector<Volume> about_path;
  for (const Volume& stack : after) {
    Volume part = cropped(stack, box);
    if (!part.voxels.empty()) about_path.push_back(std::move(part));
  }
  const Corridor corridor = needle_corridor(before, about_path, motion, frame, path);
  SearchReach search;
  search.depth_max_mm = depth_max.value;
  DepthReading reading{motion, {}};
  if (!corridor.voxels.empty()) reading.tip = find_tip(corridor, search);
  return reading;
}

DepthCheck check_depth(const Volume& before, std::span<const Volume> after, const Point& p_SE,
                       const Direction& axis_S, const DepthCheckSettings& settings,
                       DepthCheckPictures* pictures) {
  if (after.empty()) throw ConfigError("no image", "depth check", "give the image with the needle");
  const Direction unit_axis = axis_S.normalized();
  const Volume& view = widest_view(after, p_SE, unit_axis);
  const NeedleFrame frame = needle_frame(view.grid, p_SE, axis_S);
  refuse_bad(before, after, frame);
  const DepthReading reading = read_depth(before, after, frame, settings.depth_max);
  const RegistrationResult& motion = reading.motion;
  const TipFinding& tip = reading.tip;
  DepthCheck check;
  const DepthJudgement judgement = judge_depth(reading, settings);
  check.verdict = judgement.verdict;
  check.reason = judgement.reason;
  check.tip_found = needle_seen(reading.tip, settings);
  if (check.tip_found) write_placement(placement_of(tip, settings), check);
  if (settings.tip_offset) {
    check.tip_offset_known = true;
    check.tip_offset_mm = settings.tip_offset->value.value;
    check.tip_offset_sigma_mm = settings.tip_offset->sigma.value;
  }
  for (int a = 0; a < 3; ++a)
    check.shift_mm[a] = motion.shift_mm[a], check.rotation_deg[a] = motion.rotation_deg[a];
  check.registration_score = motion.score;
  check.contrast_to_noise = tip.evidence;
  if (pictures)
    draw(before, view, motion, frame, check.tip_found ? tip.depth_mm : 20.0, check.tip_found, tip, *pictures);
  return check;
}

}  // namespace biopsy::imaging
