#include "planner/imaging/registration/orthogonal_slices.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "planner/imaging/registration/reslice.hpp"

namespace biopsy::imaging {
namespace {

struct View {
  const char* name;
  Direction right_S, down_S;  // on the page, LPS
};

const std::array<View, 3> kViews{{{"axial", Direction::UnitX(), Direction::UnitY()},
                                  {"coronal", Direction::UnitX(), -Direction::UnitZ()},
                                  {"sagittal", Direction::UnitY(), -Direction::UnitZ()}}};
constexpr int kSize_px = 512;

Picture view_of(const Volume& volume, const View& view) {
  const Grid& grid = volume.grid;
  const Eigen::Vector3d middle = 0.5 * (grid.size - Eigen::Vector3i::Ones()).cast<double>();
  const Point centre_S = grid.X_SI * middle;
  const double side_mm =
      (grid.X_SI.linear() * grid.size.cast<double>().asDiagonal()).cwiseAbs().rowwise().sum().maxCoeff();
  const double step = side_mm / kSize_px;
  const Sampler sampler(volume);
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(kSize_px) * kSize_px);
  for (int row = 0; row < kSize_px; ++row)
    for (int column = 0; column < kSize_px; ++column) {
      const double right = (column - 0.5 * (kSize_px - 1)) * step, down = (row - 0.5 * (kSize_px - 1)) * step;
      values.push_back(static_cast<float>(sampler.at(centre_S + right * view.right_S + down * view.down_S)));
    }
  Picture picture = Picture::blank(kSize_px, kSize_px, step);
  paint(values, window_of(values), picture);
  return picture;
}

}  // namespace

std::vector<std::pair<std::string, Picture>> orthogonal_slices(const Volume& volume) {
  std::vector<std::pair<std::string, Picture>> out;
  out.reserve(kViews.size());
  for (const View& view : kViews) out.emplace_back(view.name, view_of(volume, view));
  return out;
}

}  // namespace biopsy::imaging
