// A fixed serialisation for hashes and signatures: integers little-endian in 64 bits, texts with their length
// before them, doubles as IEEE 754 bits.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace biopsy {

class ByteWriter {
 public:
  ByteWriter& byte(std::uint8_t value) {
    bytes_.push_back(value);
    return *this;
  }
  ByteWriter& integer(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) bytes_.push_back(static_cast<std::uint8_t>(value >> shift));
    return *this;
  }
  ByteWriter& number(double value) {  // -0 as +0, which compares equal
    return integer(std::bit_cast<std::uint64_t>(value == 0.0 ? 0.0 : value));
  }
  ByteWriter& text(std::string_view value) {
    integer(value.size());
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    return *this;
  }
  ByteWriter& raw(std::span<const std::uint8_t> value) {
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    return *this;
  }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace biopsy
