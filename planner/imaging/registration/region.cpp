#include "planner/imaging/registration/region.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace biopsy::imaging {
namespace {

// Range of voxel indices that the box's corners reach.
void index_range(const Grid& grid, const Box& box, Eigen::Vector3i& low, Eigen::Vector3i& high) {
  const AffineTransform X_IS = grid.X_SI.inverse();
  Eigen::Vector3d least = Eigen::Vector3d::Constant(1e9), most = -least;
  for (int n = 0; n < 8; ++n) {
    const Point corner((n & 1) ? box.high.x() : box.low.x(), (n & 2) ? box.high.y() : box.low.y(),
                       (n & 4) ? box.high.z() : box.low.z());
    const Eigen::Vector3d index = X_IS * corner;
    least = least.cwiseMin(index);
    most = most.cwiseMax(index);
  }
  const Eigen::Vector3d last = grid.size.cast<double>().array() - 1.0;
  low = least.array().floor().max(0.0).min(last.array() + 1.0).cast<int>();
  high = most.array().ceil().min(last.array()).max(-1.0).cast<int>();
}

int kernel_size(double sigma) {
  return 2 * static_cast<int>(std::ceil(3.0 * sigma)) + 1;
}

}  // namespace

Volume cropped(const Volume& volume, const Box& box) {
  Eigen::Vector3i low, high;
  index_range(volume.grid, box, low, high);
  Volume part;
  part.identity = volume.identity;
  part.format = volume.format;
  part.grid.X_SI = volume.grid.X_SI;
  if ((high.array() < low.array()).any()) return part;
  part.grid.size = high - low + Eigen::Vector3i::Ones();
  part.grid.X_SI.translation() = volume.grid.X_SI * low.cast<double>();
  part.voxels.reserve(part.grid.voxel_count());
  for (int k = low.z(); k <= high.z(); ++k)
    for (int j = low.y(); j <= high.y(); ++j) {
      const auto row = volume.voxels.begin() + static_cast<std::ptrdiff_t>(volume.grid.index(low.x(), j, k));
      part.voxels.insert(part.voxels.end(), row, row + part.grid.size.x());
    }
  return part;
}

Grid grid_of_cells(const Grid& grid, const Eigen::Vector3i& side) {
  Grid cells;
  cells.size = (grid.size + side - Eigen::Vector3i::Ones()).cwiseQuotient(side);
  cells.X_SI = grid.X_SI;
  cells.X_SI.linear() = grid.X_SI.linear() * side.cast<double>().asDiagonal();
  cells.X_SI.translation() = grid.X_SI * (0.5 * (side.cast<double>().array() - 1.0)).matrix();
  return cells;
}

Volume thinned(const Volume& volume, double step_mm) {
  const Grid& grid = volume.grid;
  const Eigen::Vector3i every = (step_mm / grid.spacing_mm().array()).floor().max(1.0).cast<int>();
  Volume thin;
  thin.identity = volume.identity;
  thin.format = volume.format;
  thin.grid = grid_of_cells(grid, every);
  thin.grid.X_SI.translation() = grid.X_SI.translation();  // the first voxel, no mean of many
  thin.voxels.reserve(thin.grid.voxel_count());
  for (int k = 0; k < grid.size.z(); k += every.z())
    for (int j = 0; j < grid.size.y(); j += every.y())
      for (int i = 0; i < grid.size.x(); i += every.x()) thin.voxels.push_back(volume.at(i, j, k));
  return thin;
}

Volume smoothed(const Volume& volume, double sigma_mm) {
  Volume result = volume;
  const Eigen::Vector3d sigma = sigma_mm * volume.grid.spacing_mm().cwiseInverse();
  const Eigen::Vector3i& size = volume.grid.size;
  const auto worth = [](double s) { return s > 0.2; };  // below, the kernel is one voxel
  if (volume.voxels.empty()) return result;
  if (worth(sigma.x()) || worth(sigma.y()))
    for (int k = 0; k < size.z(); ++k) {
      cv::Mat slice(size.y(), size.x(), CV_32F, result.voxels.data() + result.grid.index(0, 0, k));
      cv::GaussianBlur(slice, slice, cv::Size(kernel_size(sigma.x()), kernel_size(sigma.y())),
                       std::max(sigma.x(), 1e-3), std::max(sigma.y(), 1e-3), cv::BORDER_REPLICATE);
    }
  if (worth(sigma.z())) {
    cv::Mat stack(size.z(), size.x() * size.y(), CV_32F, result.voxels.data());
    cv::GaussianBlur(stack, stack, cv::Size(1, kernel_size(sigma.z())), 1e-3, sigma.z(),
                     cv::BORDER_REPLICATE);
  }
  return result;
}

Volume smoothed_coarse(const Volume& volume, double sigma_mm) {
  const Grid& grid = volume.grid;
  Eigen::Vector3i side = (sigma_mm / grid.spacing_mm().array()).floor().max(1.0).cast<int>();
  side.z() = 1;  // a stack of few slices stays one
  side = side.cwiseMin(grid.size).cwiseMax(1);
  if (side == Eigen::Vector3i::Ones()) return smoothed(volume, sigma_mm);
  Volume coarse;
  coarse.identity = volume.identity;
  coarse.format = volume.format;
  coarse.grid = grid_of_cells(grid, side);
  coarse.grid.size = grid.size.cwiseQuotient(side);  // whole cells only
  coarse.voxels.assign(coarse.grid.voxel_count(), 0.0f);
  const Eigen::Vector3i used = coarse.grid.size.cwiseProduct(side);
  const float share = 1.0f / static_cast<float>(side.prod());
  for (int k = 0; k < used.z(); ++k)
    for (int j = 0; j < used.y(); ++j)
      for (int i = 0; i < used.x(); ++i)
        coarse.voxels[coarse.grid.index(i / side.x(), j / side.y(), k / side.z())] +=
            share * volume.at(i, j, k);
  return smoothed(coarse, sigma_mm);
}

Volume box_averaged(Volume volume, double half_mm) {
  const Eigen::Vector3i& size = volume.grid.size;
  const Eigen::Vector3i half = (half_mm / volume.grid.spacing_mm().array()).floor().cast<int>();
  const Eigen::Vector3i side = 2 * half + Eigen::Vector3i::Ones();
  if (volume.voxels.empty()) return volume;
  for (int k = 0; k < size.z(); ++k) {
    cv::Mat slice(size.y(), size.x(), CV_32F, volume.voxels.data() + volume.grid.index(0, 0, k));
    cv::blur(slice, slice, cv::Size(side.x(), side.y()), cv::Point(-1, -1), cv::BORDER_REPLICATE);
  }
  cv::Mat stack(size.z(), size.x() * size.y(), CV_32F, volume.voxels.data());
  cv::blur(stack, stack, cv::Size(1, side.z()), cv::Point(-1, -1), cv::BORDER_REPLICATE);
  return volume;
}

}  // namespace biopsy::imaging
