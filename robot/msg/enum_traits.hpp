// Names and codes of the enums that the IDL declares.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace biopsy {

// Generated for each enum: `names` in the order of the codes (from 0, without gaps), and `unknown`, which
// stands for a code that this build does not know.
template <class Enum>
struct EnumTraits;

template <class Enum>
inline constexpr std::size_t kCount = EnumTraits<Enum>::names.size();

// "wrong session" of GateVerdict::WrongSession.
template <class Enum>
requires requires {
  EnumTraits<Enum>::names;
}
constexpr std::string_view name_of(Enum value) {
  const auto code = static_cast<std::size_t>(value);
  return code < kCount<Enum> ? EnumTraits<Enum>::names[code] : "unknown";
}

template <class Enum>
constexpr Enum from_code(std::uint8_t code) {
  return code < kCount<Enum> ? static_cast<Enum>(code) : EnumTraits<Enum>::unknown;
}

template <class Enum>
constexpr std::array<Enum, kCount<Enum>> all_values() {
  std::array<Enum, kCount<Enum>> all{};
  for (std::size_t code = 0; code < all.size(); ++code) all[code] = static_cast<Enum>(code);
  return all;
}

}  // namespace biopsy
