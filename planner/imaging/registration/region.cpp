#include "planner/imaging/registration/region.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace biopsy::imaging {
namespace {

// Smallest block of voxels that covers the box: its first voxel, and its grid, of size 0 where they do not
// meet.
struct Block {
  Eigen::Vector3i first;
  Grid grid;
};

Block block_of(const Grid& grid, const Box& box) {
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
  const Eigen::Vector3i low = least.array().floor().max(0.0).min(last.array() + 1.0).cast<int>(),
                        high = most.array().ceil().min(last.array()).max(-1.0).cast<int>();
  Block block{low, grid};
  block.grid.size.setZero();
  if ((high.array() < low.array()).any()) return block;
  block.grid.size = high - low + Eigen::Vector3i::Ones();
  block.grid.X_SI.translation() = grid.X_SI * low.cast<double>();
  return block;
}

int kernel_size(double sigma) {
  return 2 * static_cast<int>(std::ceil(3.0 * sigma)) + 1;
}

}  // namespace

Volume cropped(const Volume& volume, const Box& box) {
  const Block block = block_of(volume.grid, box);
  Volume part;
  part.identity = volume.identity;
  part.format = volume.format;
  part.grid = block.grid;
  part.voxels.reserve(part.grid.voxel_count());
  for (int k = 0; k < part.grid.size.z(); ++k)
    for (int j = 0; j < part.grid.size.y(); ++j) {
      const std::size_t at = volume.grid.index(block.first.x(), block.first.y() + j, block.first.z() + k);
      const auto row = volume.voxels.begin() + static_cast<std::ptrdiff_t>(at);
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

Volume smoothed(Volume volume, double sigma_mm) {
  const Eigen::Vector3d sigma = sigma_mm * volume.grid.spacing_mm().cwiseInverse();
  const Eigen::Vector3i& size = volume.grid.size;
  const auto worth = [](double s) { return s > 0.2; };  // below, the kernel is one voxel
  if (volume.voxels.empty()) return volume;
  if (worth(sigma.x()) || worth(sigma.y()))
    for (int k = 0; k < size.z(); ++k) {
      cv::Mat slice(size.y(), size.x(), CV_32F, volume.voxels.data() + volume.grid.index(0, 0, k));
      cv::GaussianBlur(slice, slice, cv::Size(kernel_size(sigma.x()), kernel_size(sigma.y())),
                       std::max(sigma.x(), 1e-3), std::max(sigma.y(), 1e-3), cv::BORDER_REPLICATE);
    }
  if (worth(sigma.z())) {
    cv::Mat stack(size.z(), size.x() * size.y(), CV_32F, volume.voxels.data());
    cv::GaussianBlur(stack, stack, cv::Size(1, kernel_size(sigma.z())), 1e-3, sigma.z(),
                     cv::BORDER_REPLICATE);
  }
  return volume;
}

Volume smoothed_coarse(const Volume& volume, const Box& box, double sigma_mm) {
  const Block block = block_of(volume.grid, box);
  const Eigen::Vector3i& size = block.grid.size;
  Eigen::Vector3i side = (sigma_mm / volume.grid.spacing_mm().array()).floor().max(1.0).cast<int>();
  side.z() = 1;  // a stack of few slices stays one
  side = side.cwiseMin(size).cwiseMax(1);
  if (side == Eigen::Vector3i::Ones()) return smoothed(cropped(volume, box), sigma_mm);
  Volume coarse;
  coarse.identity = volume.identity;
  coarse.format = volume.format;
  coarse.grid = grid_of_cells(block.grid, side);
  coarse.grid.size = size.cwiseQuotient(side);  // whole cells only
  coarse.voxels.reserve(coarse.grid.voxel_count());
  const float share = 1.0f / static_cast<float>(side.prod());
  Eigen::ArrayXf column(coarse.grid.size.x() * side.x());  // sums over the rows of a cell
  for (int k = 0; k < coarse.grid.size.z(); ++k)
    for (int j = 0; j < coarse.grid.size.y(); ++j) {
      const Eigen::Vector3i at = block.first + Eigen::Vector3i(0, j * side.y(), k);
      const float* row = volume.voxels.data() + volume.grid.index(at.x(), at.y(), at.z());
      column.setZero();
      for (int n = 0; n < side.y(); ++n, row += volume.grid.size.x())
        column += Eigen::Map<const Eigen::ArrayXf>(row, column.size());
      for (int i = 0; i < coarse.grid.size.x(); ++i)
        coarse.voxels.push_back(share * column.segment(i * side.x(), side.x()).sum());
    }
  return smoothed(std::move(coarse), sigma_mm);
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
