// The same work on every index, spread over the machine's cores. Results must be written to places of their
// own; the order of work does not matter then, and the answer is the same on any machine.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace biopsy::sim {

template <class Work>
void in_parallel(std::size_t count, Work&& work) {
  const std::size_t cores = std::max<std::size_t>(1, std::thread::hardware_concurrency());
  std::atomic<std::size_t> next{0};
  const auto take = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < std::min(cores, count); ++i) others.emplace_back(take);
  take();
}

}  // namespace biopsy::sim
