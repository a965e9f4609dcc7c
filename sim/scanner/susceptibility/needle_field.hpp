// How a needle disturbs the scanner's static field around it.
#pragma once

#include "sim/scanner/susceptibility/dipole_convolution.hpp"
#include "sim/scanner/susceptibility/needle_body.hpp"

namespace biopsy::sim {

// Change of the field along B0 as a fraction of B0, at points of the scanner frame. Near the tip, within
// eight radii of it, the needle is a lattice of cubes, four to a radius, partly filled at its surface, and
// the field is their dipole convolution; elsewhere the shaft is a line of dipoles, which for a round shaft is
// exact outside it but for what its ends look like. Inside the needle, where nothing gives a signal, the
// value is that of its surface.
class NeedleField {
 public:
  // `b0_S`: direction of the static field. Takes about 0.2 s. Throws ConfigError: a bad needle, no direction.
  NeedleField(const NeedleBody& needle, const Direction& b0_S);

  double at(const Point& p_S) const;
  bool inside(const Point& p_S) const;      // the needle itself
  double distance(const Point& p_S) const;  // from the axis between tip and far end, mm
  double largest() const;                   // no value is larger, nor smaller than its negative
  double reach(double fraction) const;      // mm beyond which |at| is below `fraction`, roughly

 private:
  Eigen::Vector3d in_needle(const Point& p_S) const;  // z along the insertion from the tip, mm
  double of_line(const Eigen::Vector3d& p, double from, double to) const;
  double of_lattice(const Eigen::Vector3d& p) const;

  NeedleBody needle_;
  double radius_ = 0.0, cell_ = 0.0;  // mm
  Eigen::Matrix3d R_NS_ = Eigen::Matrix3d::Identity();
  Direction b0_N_ = Direction::UnitZ();
  Lattice near_tip_;                                 // fractions of B0
  Eigen::Vector3d first_ = Eigen::Vector3d::Zero();  // its first point, mm
};

}  // namespace biopsy::sim
