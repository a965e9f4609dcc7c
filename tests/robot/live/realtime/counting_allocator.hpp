// Counts what a thread allocates, so that a test can hold a tick to allocating nothing. Link
// counting_allocator.cpp into the test: it stands in front of malloc, which operator new and C libraries call
// too.
#pragma once

#include <cstdint>

namespace biopsy::realtime {

// Allocations of this thread so far (freeing is not counted: what is freed was allocated).
std::uint64_t allocations_on_this_thread();

// Of them, those by operator new: by code in C++, not by C libraries that it calls.
std::uint64_t news_on_this_thread();

// Counts from its construction.
template <std::uint64_t (*kSoFar)()>
class Count {
 public:
  Count() : before_(kSoFar()) {}
  std::uint64_t so_far() const { return kSoFar() - before_; }

 private:
  std::uint64_t before_;
};
using AllocationCount = Count<allocations_on_this_thread>;
using NewCount = Count<news_on_this_thread>;

}  // namespace biopsy::realtime
