#include "planner/imaging/io/grid_rules.hpp"

#include <fmt/format.h>

#include <cmath>

#include "robot/common/config_error.hpp"

namespace biopsy::imaging {

void refuse_bad_size(const Eigen::Vector3i& size, const std::string& file, int slices_min) {
  const std::string text = fmt::format("{} x {} x {} voxels", size.x(), size.y(), size.z());
  if (size.head<2>().minCoeff() < kSizeMin || size.z() < slices_min)
    throw ConfigError(text + fmt::format(": a volume needs at least {} along every axis", kSizeMin), file,
                      "give the whole stack of slices, not a single picture");
  if (size.maxCoeff() > kSizeMax || size.cast<double>().prod() > kVoxelsMax)
    throw ConfigError(text + fmt::format(": more than {} along an axis or 2^31 in all", kSizeMax), file,
                      "the header is damaged, or the image must be cropped first");
}

void refuse_bad_grid(const Grid& grid, const std::string& file, int slices_min) {
  refuse_bad_size(grid.size, file, slices_min);
  const std::string remedy =
      "export the image again from the scanner or archive; do not repair the header by hand";
  if (!grid.X_SI.matrix().allFinite())
    throw ConfigError("the geometry holds a number that is not finite", file, remedy);
  const Eigen::Vector3d spacing = grid.spacing_mm();
  if (spacing.minCoeff() < 1e-3 || spacing.maxCoeff() > kSpacingMax_mm)
    throw ConfigError(fmt::format("voxel spacing {:g} x {:g} x {:g} mm is outside (0.001, {:g}]", spacing.x(),
                                  spacing.y(), spacing.z(), kSpacingMax_mm),
                      file, remedy);
  if (grid.X_SI.translation().cwiseAbs().maxCoeff() > kOriginMax_mm)
    throw ConfigError("the first voxel is more than 10 m from the scanner's isocentre", file, remedy);
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    const double cosine =
        grid.X_SI.linear().col(a).dot(grid.X_SI.linear().col(b)) / (spacing[a] * spacing[b]);
    if (std::abs(cosine) > kDirectionTolerance)
      throw ConfigError(fmt::format("sheared: the axes {} and {} meet at {:.2f} degrees, not 90", "ijk"[a],
                                    "ijk"[b], std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / EIGEN_PI),
                        file, "resample the image onto perpendicular axes, or give the original series");
  }
}

}  // namespace biopsy::imaging
