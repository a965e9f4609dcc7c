#include "planner/imaging/views/plane_views.hpp"

#include <fmt/format.h>

#include <cmath>

namespace biopsy::imaging {
namespace {

constexpr int kPlaneSize_px = 384;
constexpr double kOwnPlane = 0.98;  // cosine between a plane's normal and an axis of the volume: 11 degrees

// Which of the volume's own slices the plane is, counted along the axis that is its normal.
void number_slice(const Grid& grid, PlaneView& view) {
  const Direction normal = view.right_S.cross(view.down_S);
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(grid.X_SI.linear().col(axis).normalized().dot(normal)) < kOwnPlane) continue;
    view.slices = grid.size[axis];
    view.slice = static_cast<int>(std::lround((grid.X_SI.inverse() * view.centre_S)[axis])) + 1;
  }
}

}  // namespace

Eigen::Vector2d PlaneView::pixel(const Point& p_S) const {
  const Eigen::Vector2d middle(0.5 * (picture.width - 1), 0.5 * (picture.height - 1));
  return middle +
         Eigen::Vector2d((p_S - centre_S).dot(right_S), (p_S - centre_S).dot(down_S)) / picture.mm_per_pixel;
}

std::string PlaneView::coordinate() const {
  const Point ras = ras_from_lps(centre_S);
  const int axis = name == "axial" ? 2 : name == "coronal" ? 1 : 0;
  constexpr std::array<std::array<char, 2>, 3> kSides{{{'R', 'L'}, {'A', 'P'}, {'S', 'I'}}};
  return fmt::format("{} {:.1f} mm", kSides[static_cast<std::size_t>(axis)][ras[axis] < 0.0 ? 1 : 0],
                     std::abs(ras[axis]));
}

std::array<PlaneView, 3> plane_views(const Volume& volume, const Point& p_S, Millimetres extent) {
  std::array<PlaneView, 3> views;
  views[0].name = "axial", views[0].right_S = Direction::UnitX(), views[0].down_S = Direction::UnitY();
  views[1].name = "coronal", views[1].right_S = Direction::UnitX(), views[1].down_S = -Direction::UnitZ();
  views[2].name = "sagittal", views[2].right_S = Direction::UnitY(), views[2].down_S = -Direction::UnitZ();
  const Sampler sampler(volume);
  const double step = extent.value / kPlaneSize_px, middle = 0.5 * (kPlaneSize_px - 1);
  for (PlaneView& view : views) {
    view.centre_S = p_S;
    view.picture = Picture::blank(kPlaneSize_px, kPlaneSize_px, step);
    std::vector<float> values;
    values.reserve(static_cast<std::size_t>(kPlaneSize_px) * kPlaneSize_px);
    for (int row = 0; row < kPlaneSize_px; ++row)
      for (int column = 0; column < kPlaneSize_px; ++column)
        values.push_back(static_cast<float>(
            sampler.at(p_S + step * ((column - middle) * view.right_S + (row - middle) * view.down_S))));
    view.window = window_of(values);
    paint(values, view.window, view.picture);
    number_slice(volume.grid, view);
  }
  return views;
}

}  // namespace biopsy::imaging
