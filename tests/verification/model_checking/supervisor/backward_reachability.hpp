// How many ticks a healthy script needs from each state to Safe: backwards from all states in Safe.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace biopsy::model_checking {

inline constexpr std::uint32_t kNever = ~std::uint32_t{0};

// `keys`: the states; `steps`: from, to.
std::vector<std::uint32_t> ticks_to_safe(const std::vector<std::uint64_t>& keys,
                                         const std::vector<std::pair<std::uint32_t, std::uint32_t>>& steps);

}  // namespace biopsy::model_checking
