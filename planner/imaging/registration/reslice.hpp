// Looks at a volume along a needle: values between voxels, the needle's own axes, and grey pictures in a
// plane that contains the needle.
#pragma once

#include "robot/common/picture.hpp"
#include "robot/common/units.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

// Reads a volume between its voxel centres (trilinear). A point further than half a voxel outside has no
// value.
class Sampler {
 public:
  explicit Sampler(const Volume& volume);  // keeps a reference: the volume must outlive it

  double at(const Point& p_S) const;  // NaN outside
  // Value and its gradient per millimetre in S; false outside.
  bool at(const Point& p_S, double& value, Eigen::Vector3d& gradient) const;

 private:
  Eigen::Vector3d index_of(const Point& p) const {
    return p.x() * to_index_.col(0) + p.y() * to_index_.col(1) + p.z() * to_index_.col(2) + offset_;
  }

  const Volume& volume_;
  Eigen::Matrix3d to_index_;
  Eigen::Vector3d offset_;
};

// The needle's axes in S: `along` the insertion, `across` perpendicular to it within the image's slices
// (where resolution is best), `up` the third.
struct NeedleFrame {
  Point p_SE;
  Direction along, across, up;

  // Coordinates (along, across, up) in mm from the entry.
  Eigen::Vector3d coordinates(const Point& p_S) const {
    const Eigen::Vector3d d = p_S - p_SE;
    return {d.dot(along), d.dot(across), d.dot(up)};
  }
  Point point(double t, double u, double v) const { return p_SE + t * along + u * across + v * up; }
};

// Throws ConfigError where the axis has no length or a number is not finite.
NeedleFrame needle_frame(const Grid& grid, const Point& p_SE, const Direction& axis_S);

// Black and white of a picture, in the volume's units.
struct GreyWindow {
  double black = 0.0, white = 1.0;
};

// The 1st and 99.5th percentile of what lies in the picture: bright fat or a coil flare must not darken the
// rest.
GreyWindow window_of(const std::vector<float>& values);

// A grey picture in the plane of `along` and `across`. The needle goes to the right: `axis_px` is its unit
// direction, `across_px` that of `across`. A point t mm along and u mm across is at pixel entry_px + (t *
// axis_px + u * across_px) / mm_per_pixel (pixel centres at whole numbers).
struct NeedleSlice {
  Picture picture;
  double mm_per_pixel = 0.0;
  NeedleFrame frame;
  Eigen::Vector2d entry_px, axis_px, across_px;
  GreyWindow window;

  Eigen::Vector2d pixel(double along_mm, double across_mm) const {
    return entry_px + (along_mm * axis_px + across_mm * across_px) / mm_per_pixel;
  }
};

// `extent` is the side of the square picture, `size_px` its pixels; the entry lies a quarter from the left
// edge. What lies outside the volume is black. Throws ConfigError on a bad axis, extent or size.
NeedleSlice slice_through_needle(const Volume& volume, const Point& p_SE, const Direction& axis_S,
                                 Millimetres extent, int size_px);

// Values on the same pixel raster, NaN outside the volume; `X_VS` moves points of the picture into the
// volume's frame.
std::vector<float> values_in_plane(const Volume& volume, const NeedleSlice& raster,
                                   const RigidTransform& X_VS = RigidTransform::Identity());

void paint(const std::vector<float>& values, const GreyWindow& window, Picture& picture);

}  // namespace biopsy::imaging
