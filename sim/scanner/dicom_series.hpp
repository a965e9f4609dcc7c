// A volume as the scanner would hand it over: a DICOM series of MR images, one file a slice.
#pragma once

#include <filesystem>
#include <vector>

#include "robot/msg/volume.hpp"

namespace biopsy::sim {

// Writes MR Image Storage files slice_0001.dcm ... into `folder` (created), uncompressed, and returns them in
// order of rising position along rows x columns (a left-handed grid is so written back to front). Whole
// numbers that fit 16 bits are stored as they are; other values get the slope that spreads them over 16 bits,
// and are off by at most half of it. Geometry is exact to 1e-9 mm. Identity comes from the volume; UIDs that
// are empty or no UIDs are made from a hash of the content, so equal volumes give byte-identical files on any
// day and machine. Throws ConfigError: voxels missing or not finite, axes not perpendicular, a side beyond
// 65535, a folder that already holds .dcm files or cannot be written.
std::vector<std::filesystem::path> write_dicom_series(const Volume& volume,
                                                      const std::filesystem::path& folder);

}  // namespace biopsy::sim
