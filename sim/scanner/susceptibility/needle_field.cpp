#include "sim/scanner/susceptibility/needle_field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robot/common/config_error.hpp"

namespace biopsy::sim {
namespace {

constexpr int kCellsPerRadius = 4;
constexpr int kReach = 10;               // radii about the tip that the lattice covers
constexpr int kShaft = 25;               // radii of shaft behind the tip that are cubes
constexpr int kParts = 6;                // samples along each edge of a cube
constexpr double kLeastFraction = 1e-9;  // of B0: 0.06 Hz at 1.5 T

// The needle's profile: its radius at z (0 at the tip, negative behind).
double radius_at(const NeedleBody& needle, double z) {
  const double radius = 0.5 * needle.diameter.value;
  if (z > 0.0 || z < -needle.shaft_length.value) return 0.0;
  return needle.tip_length.value > 0.0 ? radius * std::min(-z / needle.tip_length.value, 1.0) : radius;
}

// Fraction of a cube that the needle fills.
float filled(const NeedleBody& needle, const Eigen::Vector3d& centre, double cell) {
  int count = 0;
  for (int k = 0; k < kParts; ++k) {
    const double radius = radius_at(needle, centre.z() + cell * ((k + 0.5) / kParts - 0.5));
    for (int j = 0; j < kParts; ++j)
      for (int i = 0; i < kParts; ++i)
        count += std::hypot(centre.x() + cell * ((i + 0.5) / kParts - 0.5),
                            centre.y() + cell * ((j + 0.5) / kParts - 0.5)) < radius;
  }
  return static_cast<float>(count) / (kParts * kParts * kParts);
}

}  // namespace

NeedleField::NeedleField(const NeedleBody& needle, const Direction& b0_S) : needle_(needle) {
  refuse_bad_needle(needle, "needle");
  if (!b0_S.allFinite() || b0_S.norm() < 1e-6)
    throw ConfigError("the direction of the static field is no direction", "sequence",
                      "give a vector of the scanner frame; 0, 0, 1 in a closed bore");
  radius_ = 0.5 * needle.diameter.value;
  cell_ = radius_ / kCellsPerRadius;
  R_NS_ = Eigen::Quaterniond::FromTwoVectors(needle.axis_S(), Direction::UnitZ()).toRotationMatrix();
  b0_N_ = R_NS_ * b0_S.normalized();

  const int half = kCellsPerRadius + 1, shaft = kShaft * kCellsPerRadius;
  Lattice body(Eigen::Vector3i(2 * half, 2 * half, shaft));
  const Eigen::Vector3d body_first = cell_ * Eigen::Vector3d(0.5 - half, 0.5 - half, 0.5 - shaft);
  for (int k = 0; k < shaft; ++k)
    for (int j = 0; j < 2 * half; ++j)
      for (int i = 0; i < 2 * half; ++i)
        body.at({i, j, k}) = filled(needle, body_first + cell_ * Eigen::Vector3d(i, j, k), cell_);
  const int reach = kReach * kCellsPerRadius;
  const Eigen::Vector3i size = Eigen::Vector3i::Constant(2 * reach);
  first_ = Eigen::Vector3d::Constant(cell_ * (0.5 - reach));
  near_tip_ = dipole_field(body, b0_N_, size, Eigen::Vector3i(half - reach, half - reach, shaft - reach));
  for (int k = 0; k < size.z(); ++k)
    for (int j = 0; j < size.y(); ++j)
      for (int i = 0; i < size.x(); ++i) {
        const Eigen::Vector3d p = first_ + cell_ * Eigen::Vector3d(i, j, k);
        float& value = near_tip_.at({i, j, k});
        value = static_cast<float>(needle.contrast() * static_cast<double>(value) +
                                   of_line(p, -needle.shaft_length.value, -kShaft * radius_));
      }
}

Eigen::Vector3d NeedleField::in_needle(const Point& p_S) const {
  return R_NS_ * (p_S - needle_.p_ST);
}

// A line of dipoles along the field from z = `from` to `to`, with the moment of a full shaft. With t the
// distance along the axis from a dipole to the point, R^2 = rho^2 + t^2 and b.r = beta + b_z t, the integral
// over t of (3 (b.r)^2 - R^2) / R^5 has this antiderivative.
double NeedleField::of_line(const Eigen::Vector3d& p, double from, double to) const {
  const double axial = std::clamp(p.z(), from, to);
  Eigen::Vector2d across = p.head<2>();
  double rho = across.norm();
  const double least = p.z() == axial ? radius_ : 1e-3 * radius_;  // within the shaft: its surface
  if (rho < least) {
    across = rho > 0.0 ? Eigen::Vector2d(across * (least / rho)) : Eigen::Vector2d(least, 0.0);
    rho = least;
  }
  const double beta = b0_N_.head<2>().dot(across), bz = b0_N_.z(), rho2 = rho * rho;
  const auto antiderivative = [&](double t) {
    const double R = std::sqrt(rho2 + t * t), R3 = R * R * R;
    const double i0 = t / (3.0 * rho2 * R3) + 2.0 * t / (3.0 * rho2 * rho2 * R);
    const double i1 = -1.0 / (3.0 * R3);
    const double i2 = t * t * t / (3.0 * rho2 * R3);
    return 3.0 * (beta * beta * i0 + 2.0 * beta * bz * i1 + bz * bz * i2) - t / (rho2 * R);
  };
  return needle_.contrast() * radius_ * radius_ / 4.0 *
         (antiderivative(p.z() - from) - antiderivative(p.z() - to));
}

double NeedleField::of_lattice(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d index =
      ((p - first_) / cell_).cwiseMax(0.0).cwiseMin((near_tip_.size.cast<double>().array() - 1.0).matrix());
  const Eigen::Vector3i low = index.array().floor().cast<int>().min(near_tip_.size.array() - 2);
  const Eigen::Vector3d f = index - low.cast<double>();
  double sum = 0.0;
  for (int n = 0; n < 8; ++n) {
    const Eigen::Vector3i up(n & 1, (n >> 1) & 1, n >> 2);
    double weight = 1.0;
    for (int a = 0; a < 3; ++a) weight *= up[a] ? f[a] : 1.0 - f[a];
    sum += weight * static_cast<double>(near_tip_.at(low + up));
  }
  return sum;
}

double NeedleField::at(const Point& p_S) const {
  const Eigen::Vector3d p = in_needle(p_S);
  // A cone has a third of its cylinder's volume: from afar the shaft ends two thirds of it behind the tip.
  if (p.cwiseAbs().maxCoeff() > cell_ * (kReach * kCellsPerRadius - 0.5))
    return of_line(p, -needle_.shaft_length.value, -2.0 / 3.0 * needle_.tip_length.value);
  return of_lattice(p);
}

bool NeedleField::inside(const Point& p_S) const {
  const Eigen::Vector3d p = in_needle(p_S);
  return p.head<2>().norm() < radius_at(needle_, p.z());
}

double NeedleField::distance(const Point& p_S) const {
  const Eigen::Vector3d p = in_needle(p_S);
  return (p - Eigen::Vector3d(0, 0, std::clamp(p.z(), -needle_.shaft_length.value, 0.0))).norm();
}

double NeedleField::largest() const {
  return std::abs(needle_.contrast());
}

double NeedleField::reach(double fraction) const {
  return radius_ *
         std::max(1.0, std::sqrt(0.5 * std::abs(needle_.contrast()) / std::max(fraction, kLeastFraction)));
}

}  // namespace biopsy::sim
