// JPEG 2000, which DCMTK does not decode.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace biopsy::imaging {

// Decodes one code stream (or JP2 file) of one grey component into its whole numbers, rows from the top.
// Throws ConfigError naming `file`: damaged or truncated, colour, another size, other than `bits` bits, or
// another sign than the header of the file says. Memory is bounded by the size that is asked for.
std::vector<std::int32_t> decode_jpeg2000(std::span<const std::uint8_t> bytes, int columns, int rows,
                                          int bits, bool is_signed, const std::string& file);

}  // namespace biopsy::imaging
