// Counts what a thread allocates, so that a test can hold a tick to allocating nothing. Link
// counting_allocator.cpp into the test: it stands in front of malloc, which operator new and C libraries call
// too.
#pragma once

#include <cstdint>

namespace biopsy::realtime {

// Allocations of this thread so far (freeing is not counted: what is freed was allocated).
std::uint64_t allocations_on_this_thread();

// Counts from its construction.
class AllocationCount {
 public:
  AllocationCount() : before_(allocations_on_this_thread()) {}
  std::uint64_t so_far() const { return allocations_on_this_thread() - before_; }

 private:
  std::uint64_t before_;
};

}  // namespace biopsy::realtime
