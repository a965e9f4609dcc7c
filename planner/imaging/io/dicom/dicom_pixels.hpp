// The pixels of one DICOM file, decoded frame by frame.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

class DcmItem;

namespace biopsy::imaging {

// How the pixels are stored (DICOM PS3.3 C.7.6.3).
struct PixelFormat {
  int columns = 0, rows = 0, frames = 1;
  int bits_allocated = 16, bits_stored = 16, high_bit = 15;
  bool is_signed = false;

  std::size_t pixels() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::size_t frame_bytes() const { return pixels() * static_cast<std::size_t>(bits_allocated / 8); }
};

// Throws ConfigError naming the file: colour, MONOCHROME1, other than 8, 16 or 32 bits, contradicting or
// absurd sizes.
PixelFormat read_pixel_format(DcmItem& dataset, const std::string& file);

inline constexpr double kScaleMax = 1e20;  // times a 32-bit pixel still fits a float

// Readies DCMTK once: its decoders (RLE, JPEG, JPEG-LS), silence, and a check that its data dictionary is
// there.
void ready_dicom_library();

class DicomPixels {
 public:
  // Opens the file. Throws ConfigError naming it: unreadable, no pixels, truncated, a compression that is not
  // decoded (the video formats), 32-bit big endian, or what read_pixel_format refuses.
  // Uncompressed little and big endian, deflated, RLE, JPEG, JPEG-LS and JPEG 2000 are read.
  explicit DicomPixels(const std::filesystem::path& file);
  ~DicomPixels();

  const PixelFormat& format() const;
  bool lossy() const;  // compressed so that values may differ from what was measured

  // Appends a frame (from 0), rows from the top, as stored value * slope + intercept computed in double (both
  // at most kScaleMax in size). Returns true when a value was too large (2^24) to be an exact integer.
  bool append_frame(int frame, double slope, double intercept, std::vector<float>& voxels);

 private:
  struct Open;
  std::unique_ptr<Open> open_;
};

}  // namespace biopsy::imaging
