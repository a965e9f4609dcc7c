// What every relation is folded into: order counts.
#pragma once

#include <cstdint>

namespace biopsy::safety {

class Hash {
 public:
  template <class... Values>
  void add(Values... values) {
    ((value_ = (value_ ^ static_cast<std::uint64_t>(values)) * 0x100'0000'01B3, value_ ^= value_ >> 29), ...);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF2'9CE4'8422'2325;
};

}  // namespace biopsy::safety
