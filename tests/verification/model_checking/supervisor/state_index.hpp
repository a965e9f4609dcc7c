// Number of each state seen so far, by its key: open addressing, linear probing. Keys fit in 60 bits.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace biopsy::model_checking {

class StateIndex {
 public:
  StateIndex() : slots_(1U << 16U, {kFree, 0}) {}

  // The number of `key`; `fresh` becomes its number where it was not known.
  std::pair<std::uint32_t, bool> number_of(std::uint64_t key, std::uint32_t fresh) {
    if (2 * (used_ + 1) > slots_.size()) grow();
    auto& slot = find(key);
    if (slot.first == key) return {slot.second, false};
    slot = {key, fresh};
    ++used_;
    return {fresh, true};
  }

 private:
  using Slot = std::pair<std::uint64_t, std::uint32_t>;
  static constexpr std::uint64_t kFree = ~std::uint64_t{0};

  Slot& find(std::uint64_t key) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = (key * 0x9E37'79B9'7F4A'7C15ULL >> 20U) & mask;
    while (slots_[at].first != kFree && slots_[at].first != key) at = (at + 1) & mask;
    return slots_[at];
  }

  void grow() {
    std::vector<Slot> old(2 * slots_.size(), {kFree, 0});
    old.swap(slots_);
    for (const Slot& slot : old)
      if (slot.first != kFree) find(slot.first) = slot;
  }

  std::vector<Slot> slots_;
  std::size_t used_ = 0;
};

}  // namespace biopsy::model_checking
