#include "sim/scanner/dicom_elements.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

namespace biopsy::sim {

void DicomElements::little_endian(std::uint64_t value, int count) {
  for (int byte = 0; byte < count; ++byte)
    encoded_.push_back(static_cast<char>((value >> (8 * byte)) & 0xff));
}

void DicomElements::begin(std::uint32_t tag, const char (&vr)[3]) {
  assert(tag > last_tag_ && "elements must rise");
  last_tag_ = tag;
  little_endian(tag >> 16, 2);
  little_endian(tag & 0xffff, 2);
  encoded_.append(vr, 2);
}

void DicomElements::text(std::uint32_t tag, const char (&vr)[3], std::string_view value) {
  const std::size_t length = value.size() + value.size() % 2;
  assert(length <= 0xfffe);
  begin(tag, vr);
  little_endian(length, 2);
  encoded_.append(value);
  if (value.size() % 2) encoded_.push_back(std::string_view(vr, 2) == "UI" ? '\0' : ' ');
}

void DicomElements::unsigned_short(std::uint32_t tag, std::uint16_t value) {
  begin(tag, "US");
  little_endian(2, 2);
  little_endian(value, 2);
}

void DicomElements::unsigned_long(std::uint32_t tag, std::uint32_t value) {
  begin(tag, "UL");
  little_endian(4, 2);
  little_endian(value, 4);
}

void DicomElements::bytes(std::uint32_t tag, const char (&vr)[3], std::string_view value) {
  begin(tag, vr);
  little_endian(0, 2);
  little_endian(value.size() + value.size() % 2, 4);
  encoded_.append(value);
  if (value.size() % 2) encoded_.push_back('\0');
}

void DicomElements::words(std::uint32_t tag, const std::vector<std::uint16_t>& values) {
  std::string packed;
  packed.reserve(2 * values.size());
  for (const std::uint16_t value : values) {
    packed.push_back(static_cast<char>(value & 0xff));
    packed.push_back(static_cast<char>(value >> 8));
  }
  bytes(tag, "OW", packed);
}

std::string decimal_string(double value) {
  assert(std::isfinite(value));
  if (std::abs(value) < 1e-13) return "0";  // what is left of a rotation's zero
  for (int digits = 16; digits > 1; --digits) {
    std::string text = fmt::format("{:.{}g}", value, digits);
    if (text.size() <= 16) return text;
  }
  return fmt::format("{:.1g}", value);
}

}  // namespace biopsy::sim
