// UIDs that follow from a content: the same content gives the same UID on any day and machine.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>

namespace biopsy::sim {

// FNV-1a with 64 bits, as a UID derived from an integer (PS3.5 B.2).
class ContentUid {
 public:
  ContentUid& add(const void* data, std::size_t count) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t n = 0; n < count; ++n) state_ = (state_ ^ bytes[n]) * 0x100000001b3ULL;
    return *this;
  }
  ContentUid& add(const std::string& text) { return add(text.c_str(), text.size() + 1); }  // with its zero
  std::string uid() const { return fmt::format("2.25.{}", state_); }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

}  // namespace biopsy::sim
