// Writes DICOM elements in Explicit VR Little Endian (PS3.5 chapter 7, PS3.10 chapter 7): just what a series
// of images needs. Written out here rather than with the reader's library, so that reading back what was
// written compares two independent readings of the standard.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace biopsy::sim {

class DicomElements {
 public:
  // Tags as 0xGGGGEEEE, rising (asserted): the standard wants them so.
  void text(std::uint32_t tag, const char (&vr)[3], std::string_view value);  // padded to even length
  void unsigned_short(std::uint32_t tag, std::uint16_t value);
  void unsigned_long(std::uint32_t tag, std::uint32_t value);
  void bytes(std::uint32_t tag, const char (&vr)[3], std::string_view value);  // OB, OW: long form
  void words(std::uint32_t tag, const std::vector<std::uint16_t>& values);     // OW

  const std::string& encoded() const { return encoded_; }

 private:
  void begin(std::uint32_t tag, const char (&vr)[3]);
  void little_endian(std::uint64_t value, int count);

  std::string encoded_;
  std::uint32_t last_tag_ = 0;
};

// The most exact decimal string (DS) for a number: at most 16 characters, so 1e-11 mm for positions within a
// scanner.
std::string decimal_string(double value);

}  // namespace biopsy::sim
