// How far off a fit is, measured on the two images themselves: the fit's answer to what is left over between
// them at many places beside the needle, where nothing is to be found.
#pragma once

#include <cstdint>

#include "planner/imaging/depth_check/void_fit.hpp"

namespace biopsy::imaging {

// One voxel that a fit used: how the whitened voxel answers to the parameters.
struct TemplateVoxel {
  std::uint32_t voxel;  // in Corridor::voxels
  VoidVector slope;     // d (model / standard deviation) / d parameter
};

struct ControlPlaces {
  VoidMatrix covariance = VoidMatrix::Zero();  // second moment of the parameters' errors
  double loss_alone =
      0.0;  // second moment of the loss fitted alone, all else held, times its squared information
  std::size_t count = 0;
  double mean_square = 1.0;  // of what is left over there, in standard deviations
};

// `step_for`: inverse of the fit's normal matrix. Residuals beyond `clip` standard deviations count as
// `clip`, as in the fit. `clear_mm`: voxels this near to the fitted line, before its end, are not asked.
ControlPlaces at_control_places(const Corridor& corridor, const std::vector<TemplateVoxel>& fitted,
                                const VoidMatrix& step_for, const VoidFit& fit, double clip, double clear_mm);

}  // namespace biopsy::imaging
