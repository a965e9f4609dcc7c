// NIfTI-1 images (.nii, .nii.gz; either byte order): nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h.
#pragma once

#include <filesystem>

#include "planner/imaging/io/grid_rules.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

// By name (.nii, .nii.gz).
bool looks_like_nifti(const std::filesystem::path& file);

// The grid in LPS mm, format, files and warnings, without the voxels. The sform is preferred over the qform;
// a warning tells when both are given and place a corner of the image more than 0.1 mm apart. Throws
// ConfigError naming file and reason: not NIfTI-1, neither sform nor qform, sheared, absurd geometry, more
// than three dimensions, RGB, complex, units other than mm, truncated.
Volume read_nifti_header(const std::filesystem::path& file);

// The same with the voxels as value * scl_slope + scl_inter (slope 0: as stored). A slab has fewer slices (k)
// than a volume.
Volume read_nifti(const std::filesystem::path& file, int slices_min = kSizeMin);

}  // namespace biopsy::imaging
