// DICOM slices compressed as JPEG 2000, for tests: DCMTK writes the file, OpenJPEG the pixels.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace biopsy::imaging {

// One grey component of `bits` bits, lossless.
std::vector<std::uint8_t> jpeg2000_of(const std::vector<std::int32_t>& pixels, int columns, int rows,
                                      int bits, bool is_signed);

// The slices of write_stack, each with its pixels compressed.
void write_jpeg2000_stack(const std::filesystem::path& folder, int slices);

}  // namespace biopsy::imaging
