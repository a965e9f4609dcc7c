// One medical image, from a file or a folder of DICOM, NIfTI, NRRD or MetaImage, with its place in the
// scanner (LPS mm).
#pragma once

#include <filesystem>
#include <string>

#include "planner/imaging/io/series_list.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

// Reads the series with this uid (as list_series names it), or the only one. Voxels are real-world values
// (slope and intercept applied), exact for integers up to 2^24. Throws ConfigError naming file, reason and
// remedy: several series and no uid, no such series, a damaged file, and every series that is not one
// certain, evenly spaced, perpendicular stack of at least three grey slices.
Volume read_volume(const std::filesystem::path& path, const std::string& series_uid = "");

// A confirmation image, from a single slice on: of DICOM one volume for each orientation (three orthogonal
// planes, a slab); of other formats one volume, with its slices along the third axis. Planes that a scanner
// exported as two or three series of few slices are one image. Throws as read_volume does, and where those
// are of two patients, studies or frames of reference.
std::vector<Volume> read_stacks(const std::filesystem::path& path, const std::string& series_uid = "");

}  // namespace biopsy::imaging
