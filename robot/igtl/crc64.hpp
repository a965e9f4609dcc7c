// CRC-64 of OpenIGTLink's bodies: ECMA-182, polynomial 0x42F0E1EBA9EA3693, most significant bit first,
// initial value 0.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace biopsy::igtl {

namespace crc64_table {
constexpr std::array<std::uint64_t, 256> make() {
  std::array<std::uint64_t, 256> table{};
  for (std::uint64_t byte = 0; byte < 256; ++byte) {
    std::uint64_t value = byte << 56U;
    for (int bit = 0; bit < 8; ++bit) value = (value << 1U) ^ ((value >> 63U) * 0x42F0E1EBA9EA3693U);
    table[byte] = value;
  }
  return table;
}
inline constexpr std::array<std::uint64_t, 256> kTable = make();
}  // namespace crc64_table

// `crc`: of the bytes before these.
constexpr std::uint64_t crc64(std::span<const std::uint8_t> bytes, std::uint64_t crc = 0) {
  for (const std::uint8_t byte : bytes) crc = (crc << 8U) ^ crc64_table::kTable[(crc >> 56U) ^ byte];
  return crc;
}

}  // namespace biopsy::igtl
