// Bytes as text.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace biopsy {

// Two lower-case hexadecimal digits a byte.
std::string hex(std::span<const std::uint8_t> bytes);

// RFC 4648, section 4: padded, without line breaks.
std::string base64(std::string_view bytes);

}  // namespace biopsy
