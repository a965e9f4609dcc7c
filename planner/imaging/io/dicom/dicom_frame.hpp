// Where one frame of a DICOM file lies: the items that say so, in classic and in enhanced images.
#pragma once

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <string>

#include "planner/imaging/io/dicom/stack_geometry.hpp"

namespace biopsy::imaging {

// The items that hold the attributes of one frame: the data set itself for a classic image, the functional
// groups of an enhanced one (DICOM PS3.3 C.7.6.16.2), where the frame's own group comes before the shared
// one.
struct FrameItems {
  DcmItem* position = nullptr;
  DcmItem* orientation = nullptr;
  DcmItem* measures = nullptr;
  DcmItem* scale = nullptr;    // may be missing
  DcmItem* segment = nullptr;  // of segmentations
};

FrameItems items_of_classic(DcmItem& dataset);

// Throws ConfigError naming `name` where groups are missing.
FrameItems items_of_frame(DcmItem& dataset, int frame, const std::string& name);

// Throws ConfigError where a number is missing or is none.
SlicePlane plane_of(const FrameItems& items, int columns, int rows, const std::string& name);

}  // namespace biopsy::imaging
