#include "planner/imaging/registration/reslice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "robot/common/config_error.hpp"
#include "robot/common/statistics.hpp"

namespace biopsy::imaging {
namespace {

// `inline`: these run a hundred million times a check.

// The eight voxels around an index and how far the point is between them.
struct Cell {
  double c[8];  // x first, then y, then z
  double f[3];
};

// Where an index lies between two voxels of one axis; false outside.
inline bool between(double index, int size, int& low, double& f) {
  const double last = size - 1.0;
  if (!(index >= -0.5 && index <= last + 0.5)) return false;
  const double x = std::clamp(index, 0.0, last);
  low = std::min(static_cast<int>(x), std::max(size - 2, 0));
  f = x - low;
  return true;
}

inline bool read_cell(const Volume& volume, const Eigen::Vector3d& index, Cell& cell) {
  const Eigen::Vector3i& size = volume.grid.size;
  int i, j, k;
  if (!between(index.x(), size.x(), i, cell.f[0]) || !between(index.y(), size.y(), j, cell.f[1]) ||
      !between(index.z(), size.z(), k, cell.f[2]))
    return false;
  const std::ptrdiff_t row = size.x(), slice = row * size.y();
  const std::ptrdiff_t x = size.x() > 1, y = size.y() > 1 ? row : 0, z = size.z() > 1 ? slice : 0;
  const float* const voxel = volume.voxels.data() + i + j * row + k * slice;
  const float near[8] = {voxel[0], voxel[x],     voxel[y],     voxel[x + y],
                         voxel[z], voxel[x + z], voxel[y + z], voxel[x + y + z]};
  for (int n = 0; n < 8; ++n) cell.c[n] = static_cast<double>(near[n]);
  return true;
}

inline double mix(double a, double b, double f) {
  return a + f * (b - a);
}

bool is_usable(const Eigen::Vector3d& v) {
  return v.allFinite();
}

}  // namespace

Sampler::Sampler(const Volume& volume)
    : volume_(volume),
      to_index_(volume.grid.X_SI.linear().inverse()),
      offset_(-(to_index_ * volume.grid.X_SI.translation())) {}

double Sampler::at(const Point& p_S) const {
  Cell cell;
  if (!read_cell(volume_, index_of(p_S), cell)) return std::numeric_limits<double>::quiet_NaN();
  const double *c = cell.c, *f = cell.f;
  return mix(mix(mix(c[0], c[1], f[0]), mix(c[2], c[3], f[0]), f[1]),
             mix(mix(c[4], c[5], f[0]), mix(c[6], c[7], f[0]), f[1]), f[2]);
}

bool Sampler::at(const Point& p_S, double& value, Eigen::Vector3d& gradient) const {
  Cell cell;
  if (!read_cell(volume_, index_of(p_S), cell)) return false;
  const double *c = cell.c, *f = cell.f;
  const double x00 = mix(c[0], c[1], f[0]), x10 = mix(c[2], c[3], f[0]);
  const double x01 = mix(c[4], c[5], f[0]), x11 = mix(c[6], c[7], f[0]);
  const double y0 = mix(x00, x10, f[1]), y1 = mix(x01, x11, f[1]);
  value = mix(y0, y1, f[2]);
  const Eigen::Vector3d per_index(
      mix(mix(c[1] - c[0], c[3] - c[2], f[1]), mix(c[5] - c[4], c[7] - c[6], f[1]), f[2]),
      mix(x10 - x00, x11 - x01, f[2]), y1 - y0);
  gradient = to_index_.transpose() * per_index;
  return true;
}

NeedleFrame needle_frame(const Grid& grid, const Point& p_SE, const Direction& axis_S) {
  if (!is_usable(p_SE) || !is_usable(axis_S) || axis_S.norm() < 1e-6)
    throw ConfigError(
        "the needle axis has no length or a coordinate is not a number", "entry and axis of the needle",
        "give the entry in mm and the insertion direction as three numbers that are not all zero");
  NeedleFrame frame;
  frame.p_SE = p_SE;
  frame.along = axis_S.normalized();
  const Eigen::Vector3d slice_normal = grid.X_SI.linear().col(2).normalized();
  Eigen::Vector3d across = slice_normal.cross(frame.along);
  if (across.norm() <
      0.02) {  // needle through the slices: any direction within them will do, take the columns'
    const Eigen::Vector3d column = grid.X_SI.linear().col(0).normalized();
    across = column - column.dot(frame.along) * frame.along;
  }
  frame.across = across.normalized();
  frame.up = frame.along.cross(frame.across);
  return frame;
}

GreyWindow window_of(const std::vector<float>& values) {
  std::vector<float> finite;
  finite.reserve(values.size());
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
               [](float x) { return std::isfinite(x); });
  if (finite.empty()) return {};
  GreyWindow window{static_cast<double>(quantile(finite, 0.01)),
                    static_cast<double>(quantile(finite, 0.995))};
  if (window.white - window.black < 1e-9) window.white = window.black + 1.0;
  return window;
}

std::vector<float> values_in_plane(const Volume& volume, const NeedleSlice& raster,
                                   const RigidTransform& X_VS) {
  const Sampler sampler(volume);
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(raster.picture.width) *
                 static_cast<std::size_t>(raster.picture.height));
  for (int y = 0; y < raster.picture.height; ++y)
    for (int x = 0; x < raster.picture.width; ++x) {
      const Eigen::Vector2d mm = (Eigen::Vector2d(x, y) - raster.entry_px) * raster.mm_per_pixel;
      const Point p_S = raster.frame.point(mm.dot(raster.axis_px), mm.dot(raster.across_px), 0.0);
      values.push_back(static_cast<float>(sampler.at(X_VS * p_S)));
    }
  return values;
}

void paint(const std::vector<float>& values, const GreyWindow& window, Picture& picture) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double grey = (static_cast<double>(values[i]) - window.black) / (window.white - window.black);
    const double level = std::isfinite(grey) ? std::clamp(grey, 0.0, 1.0) * 255.0 : 0.0;
    std::fill_n(picture.rgb.begin() + static_cast<std::ptrdiff_t>(3 * i), 3,
                static_cast<std::uint8_t>(std::lround(level)));
  }
}

NeedleSlice slice_through_needle(const Volume& volume, const Point& p_SE, const Direction& axis_S,
                                 Millimetres extent, int size_px) {
  if (!(extent.value > 0.0) || !std::isfinite(extent.value) || size_px < 2 || size_px > 8192)
    throw ConfigError("the picture has no size", "slice through the needle",
                      "ask for an extent above 0 mm and 2 to 8192 pixels");
  NeedleSlice slice;
  slice.frame = needle_frame(volume.grid, p_SE, axis_S);
  slice.mm_per_pixel = extent.value / size_px;
  slice.picture = Picture::blank(size_px, size_px, slice.mm_per_pixel);
  slice.axis_px = {1.0, 0.0};
  slice.across_px = {0.0, 1.0};
  slice.entry_px = {0.25 * (size_px - 1), 0.5 * (size_px - 1)};
  const std::vector<float> values = values_in_plane(volume, slice);
  slice.window = window_of(values);
  paint(values, slice.window, slice.picture);
  return slice;
}

}  // namespace biopsy::imaging
