// Frames: S scanner (patient LPS, mm), R robot (origin: needle tip at displacement zero, +z: insertion, mm),
// I image (voxel indices i, j, k; the centre of the first voxel is 0, 0, 0).
// `X_AB` maps coordinates in B to coordinates in A; `p_AB` is the position of point B in frame A: p_SE = X_SR
// * p_RE.
#pragma once

#include <Eigen/Geometry>

namespace biopsy {

using Point = Eigen::Vector3d;      // millimetres, frame in the variable's name
using Direction = Eigen::Vector3d;  // unit length, frame in the variable's name
using RigidTransform = Eigen::Isometry3d;
using AffineTransform = Eigen::Affine3d;

// People (and 3D Slicer) type RAS, DICOM and this program think in LPS: the first two axes point the other
// way.
inline Point lps_from_ras(const Point& ras) {
  return {-ras.x(), -ras.y(), ras.z()};
}
inline Point ras_from_lps(const Point& lps) {
  return {-lps.x(), -lps.y(), lps.z()};
}

}  // namespace biopsy
