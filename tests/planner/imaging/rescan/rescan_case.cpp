#include "tests/planner/imaging/rescan/rescan_case.hpp"

#include <cmath>
#include <filesystem>
#include <numbers>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/version.hpp>
#include <random>

#include "planner/imaging/io/byte_source.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "planner/imaging/registration/reslice.hpp"
#include "robot/common/statistics.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::imaging::rescan {
namespace {

// The same numbers on every machine, which the distributions of the standard library do not promise.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : bits_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1.0p-53;
  }
  int below(int n) { return std::min(static_cast<int>(between(0.0, n)), n - 1); }
  Direction perpendicular_to(const Direction& axis) {
    const double angle = between(0.0, 2.0 * std::numbers::pi);
    const Direction a = axis.unitOrthogonal(), b = axis.cross(a);
    return std::cos(angle) * a + std::sin(angle) * b;
  }

 private:
  std::mt19937_64 bits_;
};

std::optional<Volume> real_volume(const std::string& name) {
  const auto path = source_dir() / "../shared/data/images/mr" / name;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return read_volume(path);
}

// The two volumes of a file in four dimensions, which no reader here takes: its header with three, and the
// voxels of one.
std::optional<Pair> brain_pair() {
  const std::filesystem::path file = "/usr/lib/python3/dist-packages/nibabel/tests/data/example4d.nii.gz";
  if (!std::filesystem::exists(file)) return std::nullopt;
  constexpr std::size_t kHeader = 416, kVoxels = 2 * 128 * 96 * 24;  // bytes
  std::string content(kHeader + 2 * kVoxels, '\0');
  ByteSource(file, ByteSource::Packing::Gzip).read(std::as_writable_bytes(std::span(content)));
  content[40] = 3, content[48] = 1;  // dim[0], dim[4]
  const ScratchFolder folder;
  folder.write("before.nii", content.substr(0, kHeader + kVoxels));
  folder.write("after.nii", content.substr(0, kHeader) + content.substr(kHeader + kVoxels));
  return Pair{"brain", read_volume(folder / "before.nii"), read_volume(folder / "after.nii")};
}

double tissue_of(const Volume& volume) {
  std::vector<float> bright;
  const float air = 0.1f * quantile(volume.voxels, 0.99);
  for (float value : volume.voxels)
    if (value > air) bright.push_back(value);
  return static_cast<double>(quantile(bright, 0.5));
}

bool through_tissue(const Sampler& sampler, const PaintedNeedle& needle, double tissue) {
  int bright = 0, count = 0;
  for (double t = -3.0; t <= needle.tip_mm + 8.0; t += 1.0, ++count) {
    const double value = sampler.at(needle.p_SE + t * needle.axis_S);
    if (std::isnan(value)) return false;
    bright += value > 0.35 * tissue;
  }
  for (double t = needle.tip_mm - 3.0; t <= needle.tip_mm + 3.0; t += 0.5)
    if (!(sampler.at(needle.p_SE + t * needle.axis_S) > 0.4 * tissue)) return false;
  return bright >= 0.85 * count;
}

PaintedNeedle drawn_needle(const Grid& grid, Draw& draw) {
  PaintedNeedle needle;
  Eigen::Vector3d index;
  for (int a = 0; a < 3; ++a) index[a] = draw.between(0.0, grid.size[a] - 1.0);
  needle.p_SE = grid.X_SI * index;
  const Direction main = grid.X_SI.linear().col(draw.below(3)).normalized();
  const double tilt = draw.between(0.0, 10.0) * std::numbers::pi / 180.0;
  needle.axis_S = std::cos(tilt) * main + std::sin(tilt) * draw.perpendicular_to(main);
  if (draw.below(2) == 1) needle.axis_S = -needle.axis_S;
  needle.tip_mm = draw.below(2) == 0 ? draw.between(4.0, 12.0) : draw.between(20.0, 45.0);
  needle.radius_mm = draw.between(0.9, 2.6);
  needle.soft_mm = draw.between(0.15, 0.5);
  needle.roundness = draw.between(0.0, 1.0);
  const int shape = draw.below(3);
  needle.bulb = shape == 1 ? draw.between(0.2, 0.7) : 0.0;
  needle.pile_up = shape == 2 ? draw.between(0.2, 0.6) : 0.0;
  needle.loss = draw.between(0.75, 1.0);
  return needle;
}

// Another patient's volume, moved so that its middle lies on `p_S`.
Volume centred_on(Volume volume, const Point& p_S) {
  const Eigen::Vector3d middle = 0.5 * (volume.grid.size.cast<double>().array() - 1.0);
  volume.grid.X_SI.translation() += p_S - volume.grid.X_SI * middle;
  return volume;
}

void put_plan_wrong(Kind kind, Draw& draw, RescanCase& c) {
  const Direction side = draw.perpendicular_to(c.needle.axis_S);
  if (kind == Kind::Beside5mm) c.plan_p_SE += 5.0 * side;
  if (kind == Kind::Tilted6deg) {
    const double angle = 6.0 * std::numbers::pi / 180.0;
    c.plan_axis_S = std::cos(angle) * c.needle.axis_S + std::sin(angle) * side;
  }
}

}  // namespace

std::string_view label(Kind kind) {
  switch (kind) {
    case Kind::RightPlan:
      return "right plan";
    case Kind::Beside5mm:
      return "5 mm beside the planned axis";
    case Kind::Tilted6deg:
      return "tilted by 6 degrees";
    case Kind::NoNeedle:
      return "without needle";
    case Kind::OtherPatient:
      return "another patient";
    case Kind::Swapped:
      return "images swapped";
    case Kind::OldTrack:
      return "right plan, an old track beside the needle";
  }
  return "";
}

std::optional<Pair> real_pair(std::string_view name) {
  if (name == "brain") return brain_pair();
  auto guidance = real_volume("prostate_guidance");
  auto other = real_volume(name == "planning" ? "prostate_planning" : "prostate_guidance_2");
  if (!guidance || !other) return std::nullopt;
  Pair pair{std::string(name), std::move(*guidance), std::move(*other)};
  if (name != "rescan") std::swap(pair.before, pair.after);
  return pair;
}

std::optional<RescanCase> drawn(const Pair& pair, Kind kind, std::uint64_t seed) {
  const double tissue = tissue_of(pair.after);
  const Sampler sampler(pair.after);
  Draw draw(seed * 64 + static_cast<std::uint64_t>(kind));
  for (int attempt = 0; attempt < 20000; ++attempt) {
    RescanCase c;
    c.needle = drawn_needle(pair.after.grid, draw);
    if (!through_tissue(sampler, c.needle, tissue)) continue;
    const Sampler earlier(pair.before);
    if (std::isnan(earlier.at(c.needle.p_SE)) ||
        std::isnan(earlier.at(c.needle.p_SE + (c.needle.tip_mm + 8.0) * c.needle.axis_S)))
      continue;  // only one of the images shows it
    const double floor = draw.between(0.01, 0.04) * tissue;
    c.plan_p_SE = c.needle.p_SE;
    c.plan_axis_S = c.needle.axis_S;
    c.plan_depth_mm = c.needle.tip_mm;
    put_plan_wrong(kind, draw, c);
    if (c.plan_depth_mm < 1.0) continue;
    c.before = pair.before;
    c.after = kind == Kind::NoNeedle ? pair.after : painted(pair.after, c.needle, floor);
    if (kind == Kind::OtherPatient) {
      const auto liver = real_volume("liver/example_mr_sm.nii.gz");
      if (!liver) return std::nullopt;
      c.before = centred_on(*liver, c.plan_p_SE);
    }
    if (kind == Kind::OldTrack) {
      PaintedNeedle track = c.needle;
      track.p_SE += draw.between(4.0, 8.0) * draw.perpendicular_to(c.needle.axis_S);
      track.tip_mm += draw.between(-3.0, 7.0);
      track.radius_mm = draw.between(0.8, 1.5), track.loss = 0.7, track.bulb = track.pile_up = 0.0;
      c.before = painted(c.before, track, floor);
      c.after = painted(c.after, track, floor);
    }
    if (kind == Kind::Swapped) std::swap(c.before, c.after);
    return c;
  }
  return std::nullopt;
}

std::string opencv_in_use() {
  const char* vectors = cv::checkHardwareSupport(CV_CPU_AVX512_SKX) ? "AVX-512"
                        : cv::checkHardwareSupport(CV_CPU_AVX2)     ? "AVX2"
                                                                    : "neither";
  return std::string("OpenCV " CV_VERSION ", ") + vectors;
}

}  // namespace biopsy::imaging::rescan
