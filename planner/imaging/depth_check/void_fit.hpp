// Fits depth, place, direction and shape of one straight void to the voxels around it, and measures on the
// same two images how far off such a fit is.
#pragma once

#include "planner/imaging/depth_check/line_candidates.hpp"

namespace biopsy::imaging {

// What is fitted. The line is given where the void ends, so that depth and place do not depend on each other.
enum VoidParameter : int { kDepth, kU, kV, kUSlope, kVSlope, kLogRadius, kLogSoft, kRounding, kLoss };
inline constexpr int kVoidParameters = 9;
using VoidVector = Eigen::Matrix<double, kVoidParameters, 1>;
using VoidMatrix = Eigen::Matrix<double, kVoidParameters, kVoidParameters>;

struct VoidFit {
  VoidLine line;
  double depth_mm = 0.0;          // where the centreline has lost half of what it loses
  double u_mm = 0.0, v_mm = 0.0;  // beside the expected axis, there or where the images end
  double soft_mm = 0.4, rounding = 0.5, loss = 0.0;
  double gain = 0.0;                // what the void explains: fall of chi-square against "nothing changed"
  double chi2 = 0.0, misfit = 1.0;  // misfit: reduced chi-square
  VoidMatrix covariance = VoidMatrix::Zero();  // of the parameters, as measured beside the void
  double loss_sigma = 0.0;                     // of the loss with all else held, measured likewise
  // How many times larger its variance is than independent voxels would give it: neighbours err alike
  // (interpolation, motion). Evidence counts for that much less. 1 or more.
  double inflation = 1.0;
  std::size_t control_places = 0;  // where it was measured
  // How far off another void lies that explains the images as well: across a single slice, say. Zero: none.
  Eigen::Vector2d other_place = Eigen::Vector2d::Zero(), other_slope = Eigen::Vector2d::Zero();
  bool led_away = false;  // nothing was fitted, for every fit ended beyond what was searched

  // By how many standard deviations signal is lost; 0 where no place beside it tells how large they are.
  double evidence() const { return control_places > 0 ? loss / std::max(loss_sigma, 1e-6) : 0.0; }
  double sigma(VoidParameter p) const { return std::sqrt(std::max(covariance(p, p), 0.0)); }
};

// The best of the fits that start from `candidates`, lines and tips known to about 2 mm and 2 degrees. At
// least one. A fit that ends beyond `reach`, in which they were sought, is none.
VoidFit fit_void(const Corridor& corridor, const std::vector<LineCandidate>& candidates,
                 const SearchReach& reach);

// Chi-square of the void with its tip elsewhere and all else as fitted, but for what its core loses, for each
// of `depths`; voxels near the centreline only, the form of a wide void's rim has no say in its depth.
std::vector<double> chi2_by_depth(const Corridor& corridor, const VoidFit& fit,
                                  const std::vector<double>& depths);

}  // namespace biopsy::imaging
