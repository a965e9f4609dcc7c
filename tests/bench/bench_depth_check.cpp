// What a check of the depth costs: three planes along a needle, and a whole volume, out of a real re-scan of
// one patient (../shared/data/images/mr) with needles drawn into it; beside one Gaussian blur by OpenCV of
// the same volume. CPU time of one thread, the better of two.
//   bench_depth_check [needles [keep]]      keep: the table of the documentation anew
// Exit code 77 where the images are absent.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "tests/bench/bench_result.hpp"
#include "tests/kept_figures.hpp"
#include "tests/planner/imaging/rescan/rescan_case.hpp"

namespace biopsy::bench {
namespace {

using imaging::rescan::RescanCase;

// columns: steps along rows, columns and slices, mm
Volume resampled(const Volume& from, const Point& centre, const Eigen::Matrix3d& steps,
                 const Eigen::Vector3i& size) {
  const imaging::Sampler sampler(from);
  Volume to;
  to.grid.size = size;
  to.grid.X_SI.linear() = steps;
  to.grid.X_SI.translation() = centre - steps * (0.5 * (size.cast<double>().array() - 1.0)).matrix();
  for (int k = 0; k < size.z(); ++k)
    for (int j = 0; j < size.y(); ++j)
      for (int i = 0; i < size.x(); ++i) {
        const double value = sampler.at(to.grid.X_SI * Eigen::Vector3d(i, j, k));
        to.voxels.push_back(std::isnan(value) ? 0.0f : static_cast<float>(value));
      }
  return to;
}

// Two planes along the needle and one across it, as a confirmation scan has them.
std::vector<Volume> three_planes(const RescanCase& drawn) {
  constexpr double kPixel_mm = 0.75, kThick_mm = 3.6;
  const Direction along = drawn.plan_axis_S, beside = along.unitOrthogonal(), up = along.cross(beside);
  const Point tip = drawn.plan_p_SE + drawn.plan_depth_mm * along;
  std::vector<Volume> planes;
  for (const auto& [row, column] : {std::pair{along, beside}, std::pair{along, up}, std::pair{beside, up}}) {
    Eigen::Matrix3d steps;
    steps << kPixel_mm * row, kPixel_mm * column, kThick_mm * row.cross(column);
    planes.push_back(resampled(drawn.after, tip, steps, {256, 256, 1}));
  }
  return planes;
}

// The whole image in the voxels of a large one.
std::vector<Volume> large_volume(const RescanCase& drawn) {
  constexpr std::array<int, 3> kSize{512, 512, 200};
  const Grid& grid = drawn.after.grid;
  Eigen::Matrix3d steps = grid.X_SI.linear();
  for (int a = 0; a < 3; ++a)
    steps.col(a) *= static_cast<double>(grid.size[a]) / kSize[static_cast<std::size_t>(a)];
  const Point centre = grid.X_SI * (0.5 * (grid.size.cast<double>().array() - 1.0)).matrix();
  return {resampled(drawn.after, centre, steps, {kSize[0], kSize[1], kSize[2]})};
}

struct Cost {
  double sum_s = 0.0, worst_s = 0.0;
  int checks = 0;

  void measure(const RescanCase& drawn, const std::vector<Volume>& after) {
    imaging::DepthCheckSettings settings;
    settings.expected = Millimetres(drawn.plan_depth_mm);
    settings.tip_offset = TipOffset{"p", "r", Millimetres(drawn.needle.beyond_mm), Millimetres(0.15)};
    double best_s = 1e9;
    for (int repetition = 0; repetition < 2; ++repetition) {
      const double begin_s = cpu_s();
      imaging::check_depth(drawn.before, after, drawn.plan_p_SE, drawn.plan_axis_S, settings);
      best_s = std::min(best_s, cpu_s() - begin_s);
    }
    sum_s += best_s, worst_s = std::max(worst_s, best_s), ++checks;
  }
  std::vector<std::string> row(const char* what, double peer_s) const {
    return {what, std::to_string(checks), fmt::format("{:.2f}", sum_s / checks),
            fmt::format("{:.2f}", worst_s), fmt::format("{:.1f}", worst_s / peer_s)};
  }
};

double blur_s(Volume volume) {
  const double begin_s = cpu_s();
  for (int k = 0; k < volume.grid.size.z(); ++k) {
    cv::Mat slice(volume.grid.size.y(), volume.grid.size.x(), CV_32F,
                  volume.voxels.data() + volume.grid.index(0, 0, k));
    cv::GaussianBlur(slice, slice, {}, 2.0);
  }
  return cpu_s() - begin_s;
}

int run(std::uint64_t needles, bool keep) {
  cv::setNumThreads(1);
  const auto pair = imaging::rescan::real_pair("rescan");
  if (!pair) {
    fmt::print(stderr, "error: no real scans in ../shared/data/images/mr\n");
    return 77;
  }
  Cost planes, volume;
  double peer_s = 0.0;
  for (std::uint64_t seed = 1; seed <= needles; ++seed) {
    const auto drawn = imaging::rescan::drawn(*pair, imaging::rescan::Kind::RightPlan, seed);
    if (!drawn) continue;
    planes.measure(*drawn, three_planes(*drawn));
    if (seed % 4 != 1) continue;  // a large volume takes longer to make than to check
    const std::vector<Volume> large = large_volume(*drawn);
    volume.measure(*drawn, large);
    if (peer_s == 0.0) peer_s = blur_s(large.front());
  }
  const std::vector<std::vector<std::string>> rows{
      planes.row("three planes of 256 x 256, two along the needle", peer_s),
      volume.row("512 x 512 x 200 voxels", peer_s)};
  fmt::print("{:<50}{:>8}{:>10}{:>10}{:>12}\n", "CPU time, s", "checks", "mean", "worst", "worst/blur");
  for (const auto& row : rows)
    fmt::print("{:<50}{:>8}{:>10}{:>10}{:>12}\n", row[0], row[1], row[2], row[3], row[4]);
  fmt::print("{:<50}{:>8}{:>10.3f}\n", "one Gaussian blur of the latter", 1, peer_s);
  if (keep)
    write_figures("depth-check-cost", {fmt::format("./dev bench depth_check {} keep", needles),
                                       "explanation/depth-check.md", "OpenCV " CV_VERSION, rows});
  return 0;
}

}  // namespace
}  // namespace biopsy::bench

int main(int argc, char** argv) {
  const int needles = argc > 1 ? std::atoi(argv[1]) : 24;
  const bool keep = argc == 3 && std::string(argv[2]) == "keep";
  if (argc > (keep ? 3 : 2) || needles < 1) {
    fmt::print(stderr, "error: bench_depth_check takes a number of needles, and after it `keep`\n");
    return 2;
  }
  return biopsy::bench::run(static_cast<std::uint64_t>(needles), keep);
}
