// Where the robot stands in the scanner: the rigid transform X_SR (robot R to scanner S, LPS mm) and how far
// it can be trusted at the target.
#pragma once

#include <array>
#include <string>
#include <variant>
#include <vector>

#include "robot/common/frames.hpp"
#include "robot/msg/plan.hpp"

namespace biopsy::planner {

// One fiducial seen in both frames.
struct FiducialPair {
  std::string name;
  Point p_RF = Point::Zero();  // robot, mm
  Point p_SF = Point::Zero();  // scanner, LPS mm
};

// A result that was accepted: pairs are kept because the expected error depends on where they lie.
struct Registration {
  RigidTransform X_SR = RigidTransform::Identity();
  double fre_mm = 0.0;              // root mean square of residual_mm
  std::vector<double> residual_mm;  // one a pair, same order
  std::vector<FiducialPair> pairs;
};

// A fiducial is localised to about half a voxel, 0.5 mm in 1 mm voxels; twice that is a slipped or swapped
// marker.
inline constexpr double kFreLimit_mm = 1.0;
// Fiducials must extend this far (rms) in two directions. Less, and with 0.5 mm localisation error the
// rotation about their common line is uncertain by more than 3 degrees.
inline constexpr double kSpreadMin_mm = 5.0;

// Least-squares rotation and translation without reflection (Kabsch 1976, Umeyama 1991). Refuses fewer than
// three pairs, collinear ones and an FRE above kFreLimit_mm, naming the worst fiducial.
std::variant<Registration, PlanRefusal> register_robot(const std::vector<FiducialPair>& pairs);

// Expected target registration error (rms, mm) at a point: TRE^2 = FLE^2 / N (1 + 1/3 sum_k d_k^2 / f_k^2)
// with FLE^2 = FRE^2 N / (N - 2), d_k and f_k the distances of target and fiducials (rms) from principal axis
// k. Fitzpatrick, West & Maurer 1998, IEEE TMI 17(5):694-702.
double expected_tre_mm(const Registration& registration, const Point& p_ST);

// A transform given by a person: 4 x 4, row-major, robot mm to scanner RAS mm, the convention of 3D Slicer.
// Throws ConfigError at `where` unless it is a rotation and a translation to 1e-4.
RigidTransform rigid_transform_from_ras(const std::array<double, 16>& rows, const std::string& where);

// The pose the needle guide must have for the needle to wait at the entry and point at the target: origin at
// p_SE, +z towards p_ST; the turn about the needle is arbitrary. Throws ConfigError where the two points are
// less than 0.01 mm apart.
RigidTransform needle_pose(const Point& p_SE, const Point& p_ST);

}  // namespace biopsy::planner
