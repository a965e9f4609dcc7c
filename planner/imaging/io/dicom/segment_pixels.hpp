// The pixels of a DICOM segmentation (PS3.3 C.8.20.2): which segment each pixel of a frame is in.
#pragma once

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planner/imaging/io/dicom/dicom_pixels.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::imaging {

[[noreturn]] inline void refuse_segmentation(const std::string& what, const std::string& where) {
  throw ConfigError(what, where, "export the segmentation again, as binary and uncompressed, or as NRRD");
}

enum class SegmentationKind : std::uint8_t {
  Binary,      // a bit a pixel; a frame is of one segment
  Fractional,  // a share of occupancy or probability a pixel; a frame is of one segment
  LabelMap,    // the number of its segment a pixel
};

// Throws ConfigError naming `file` for any other.
SegmentationKind segmentation_kind(DcmItem& dataset, const std::string& file);

class SegmentPixels {
 public:
  // `dataset` of `file` must outlive this. Throws ConfigError naming the file: missing, truncated, a size of
  // pixels that is not its kind's, a compression that is not decoded or may have changed them.
  SegmentPixels(DcmItem& dataset, SegmentationKind kind, const std::filesystem::path& file,
                std::size_t pixels, std::size_t frames);

  // Of a frame of `segment` (of a label map: ignored), rows from the top: segment of each pixel, 0 in none. A
  // pixel of a fractional segmentation is in the segment where more than half of the most is stored.
  const std::vector<int>& frame(std::size_t number, int segment);

 private:
  SegmentationKind kind_;
  std::size_t pixels_;
  const Uint8* bits_ = nullptr;
  std::optional<DicomPixels> decoded_;
  float half_ = 0.0F;
  std::vector<float> values_;
  std::vector<int> segments_;
};

}  // namespace biopsy::imaging
