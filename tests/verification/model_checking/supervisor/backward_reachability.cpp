#include "tests/verification/model_checking/supervisor/backward_reachability.hpp"

#include "tests/verification/model_checking/supervisor/states.hpp"

namespace biopsy::model_checking {

std::vector<std::uint32_t> ticks_to_safe(const std::vector<std::uint64_t>& keys,
                                         const std::vector<std::pair<std::uint32_t, std::uint32_t>>& steps) {
  // Predecessors of i are sources[first[i]] .. sources[first[i + 1] - 1].
  std::vector<std::uint32_t> first(keys.size() + 2, 0), sources(steps.size());
  for (const auto& [from, to] : steps) ++first[to + 2];
  for (std::size_t i = 2; i < first.size(); ++i) first[i] += first[i - 1];
  for (const auto& [from, to] : steps) sources[first[to + 1]++] = from;
  std::vector<std::uint32_t> ticks(keys.size(), kNever), queue;
  for (std::uint32_t i = 0; i < keys.size(); ++i)
    if (state_of(keys[i]).mode == Mode::Safe) ticks[i] = 0, queue.push_back(i);
  for (std::size_t at = 0; at < queue.size(); ++at)
    for (std::uint32_t s = first[queue[at]]; s < first[queue[at] + 1]; ++s)
      if (ticks[sources[s]] == kNever) ticks[sources[s]] = ticks[queue[at]] + 1, queue.push_back(sources[s]);
  return ticks;
}

}  // namespace biopsy::model_checking
