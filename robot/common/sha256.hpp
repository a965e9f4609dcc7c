// SHA-256 (FIPS 180-4), by OpenSSL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace biopsy {

using Sha256 = std::array<std::uint8_t, 32>;

// The first 8 bytes, most significant first: the hexadecimal form begins with that of this number.
inline std::uint64_t first_64_bits(const Sha256& digest) {
  std::uint64_t tag = 0;
  for (std::size_t n = 0; n < 8; ++n) tag = tag << 8 | digest[n];
  return tag;
}

Sha256 sha256(std::span<const std::byte> bytes);
Sha256 sha256(std::string_view bytes);

}  // namespace biopsy
