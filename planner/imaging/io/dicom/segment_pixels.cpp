#include "planner/imaging/io/dicom/segment_pixels.hpp"

#include <fmt/format.h>

#include "planner/imaging/io/dicom/dicom_fields.hpp"
#include "robot/common/text/sanitize_text.hpp"

namespace biopsy::imaging {
namespace {

// The bits, of one frame behind the other without padding between, the lowest bit of a byte first.
const Uint8* find_bits(DcmItem& dataset, std::size_t count, const std::string& file) {
  const Uint8* bytes = nullptr;
  unsigned long length = 0;
  const DcmXfer syntax(dynamic_cast<DcmDataset&>(dataset).getOriginalXfer());
  if (dataset.findAndGetUint8Array(DCM_PixelData, bytes, &length).bad() || bytes == nullptr)
    refuse_segmentation(
        dataset.tagExists(DCM_PixelData)
            ? fmt::format("compressed as {}: segments of one bit a pixel are read uncompressed or deflated",
                          syntax.getXferName())
            : "it has no pixels",
        file);
  if (length < (count + 7) / 8)
    refuse_segmentation(
        fmt::format("truncated: {} bytes of pixels, {} are promised", length, (count + 7) / 8), file);
  return bytes;
}

float half_of_most(DcmItem& dataset, const std::string& file) {
  const int most = dicom_unsigned_short(dataset, DCM_MaximumFractionalValue).value_or(0);
  if (most < 1 || most > 255)
    refuse_segmentation(fmt::format("MaximumFractionalValue is {}, not a number from 1 to 255", most), file);
  return 0.5F * static_cast<float>(most);
}

}  // namespace

SegmentationKind segmentation_kind(DcmItem& dataset, const std::string& file) {
  const std::string kind = dicom_text(dataset, DCM_SegmentationType);
  if (kind == "BINARY") return SegmentationKind::Binary;
  if (kind == "FRACTIONAL") return SegmentationKind::Fractional;
  if (kind == "LABELMAP") return SegmentationKind::LabelMap;
  refuse_segmentation(
      fmt::format("a segmentation of the type \"{:.20}\": BINARY, FRACTIONAL and LABELMAP are read",
                  plain(kind)),
      file);
}

SegmentPixels::SegmentPixels(DcmItem& dataset, SegmentationKind kind, const std::filesystem::path& path,
                             std::size_t pixels, std::size_t frames)
    : kind_(kind), pixels_(pixels), segments_(pixels) {
  const std::string file = path.string();
  const auto bits = dicom_unsigned_short(dataset, DCM_BitsAllocated);
  const bool one_sample = dicom_unsigned_short(dataset, DCM_SamplesPerPixel).value_or(1) == 1;
  if (kind == SegmentationKind::Binary) {
    if (bits != 1 || !one_sample) refuse_segmentation("the segments are not stored as one bit a pixel", file);
    bits_ = find_bits(dataset, pixels * frames, file);
    return;
  }
  const bool fractional = kind == SegmentationKind::Fractional;
  if (!(bits == 8 || (bits == 16 && !fractional)) || !one_sample)
    refuse_segmentation(
        fmt::format("the segments are not stored as {} bits a pixel", fractional ? "8" : "8 or 16"), file);
  if (fractional) half_ = half_of_most(dataset, file);
  decoded_.emplace(path);
  if (decoded_->lossy()) refuse_segmentation("compressed with loss: its borders may have moved", file);
  const PixelFormat& format = decoded_->format();
  if (format.pixels() != pixels || static_cast<std::size_t>(format.frames) < frames)
    refuse_segmentation("its pixels are not those of its frames", file);
  if (format.is_signed) refuse_segmentation("its pixels are signed numbers", file);
}

const std::vector<int>& SegmentPixels::frame(std::size_t number, int segment) {
  if (kind_ == SegmentationKind::Binary) {
    for (std::size_t n = 0; n < pixels_; ++n) {
      const std::size_t bit = number * pixels_ + n;
      segments_[n] = (bits_[bit / 8] >> (bit % 8) & 1U) != 0 ? segment : 0;
    }
    return segments_;
  }
  values_.clear();
  decoded_->append_frame(static_cast<int>(number), 1.0, 0.0, values_);
  for (std::size_t n = 0; n < pixels_; ++n)
    segments_[n] = kind_ == SegmentationKind::LabelMap ? static_cast<int>(values_[n])
                   : values_[n] > half_                ? segment
                                                       : 0;
  return segments_;
}

}  // namespace biopsy::imaging
