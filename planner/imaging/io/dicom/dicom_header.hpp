// What one DICOM file says about itself and about the slices in it, without the pixels.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planner/imaging/io/dicom/stack_geometry.hpp"
#include "robot/common/config_error.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

struct DicomSlice {
  SlicePlane plane;
  std::filesystem::path file;
  int frame = 0;
  double slope = 1.0, intercept = 0.0;  // stored value to real-world value
};

struct DicomFile {
  std::filesystem::path file;
  SeriesIdentity identity;
  std::string image_type;                                         // "ORIGINAL\PRIMARY\M"
  std::optional<std::chrono::system_clock::time_point> acquired;  // by the scanner's clock
  int images_in_acquisition = 0;                                  // as stated; 0: not stated
  bool readable = false;                                          // DICOM all through to the pixels
  bool is_image = false;               // a report, structure set or DICOMDIR is none
  std::vector<DicomSlice> slices;      // one, or one a frame of an enhanced image
  std::optional<ConfigError> refusal;  // why it cannot be part of a volume

  bool localiser() const { return image_type.find("LOCALIZER") != std::string::npos; }
};

// By content: "DICM" behind a preamble, or a data set that begins with group 0008 where the preamble was
// lost. Also by name (.dcm, .ima), so that a file cut down to nothing is refused instead of missing from its
// stack.
bool looks_like_dicom(const std::filesystem::path& file);

// Never throws for what the file holds: the refusal is part of the answer, so that one bad file does not hide
// the rest. Geometry comes from ImagePositionPatient, ImageOrientationPatient and PixelSpacing, for enhanced
// multi-frame images from the functional groups of each frame (or shared). Other multi-frame images and
// mosaics are refused by name.
DicomFile scan_dicom_file(const std::filesystem::path& file);

}  // namespace biopsy::imaging
