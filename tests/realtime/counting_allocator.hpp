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

class NewCount {
 public:
  NewCount() : before_(news_on_this_thread()) {}
  std::uint64_t so_far() const { return news_on_this_thread() - before_; }

 private:
  std::uint64_t before_;
};

// Counts from its construction.
class AllocationCount {
 public:
  AllocationCount() : before_(allocations_on_this_thread()) {}
  std::uint64_t so_far() const { return allocations_on_this_thread() - before_; }

 private:
  std::uint64_t before_;
};

}  // namespace biopsy::realtime
