#include "tests/robot/live/realtime/counting_allocator.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <new>

// A sanitizer has taken malloc's place already and lets us listen there; else we stand in front of glibc's.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*)(const volatile void*, std::size_t),
                                                         void (*)(const volatile void*));
#define BIOPSY_UNDER_SANITIZER 1
#endif

namespace {

constinit thread_local std::uint64_t allocations = 0, news = 0;

}  // namespace

std::uint64_t biopsy::realtime::allocations_on_this_thread() {
  return allocations;
}

std::uint64_t biopsy::realtime::news_on_this_thread() {
  return news;
}

void* operator new(std::size_t size) {
  ++news;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

#ifdef BIOPSY_UNDER_SANITIZER

namespace {

void on_allocation(const volatile void*, std::size_t) {
  ++allocations;
}
void on_release(const volatile void*) {}

[[maybe_unused]] const int kInstalled = __sanitizer_install_malloc_and_free_hooks(on_allocation, on_release);

}  // namespace

#else

extern "C" {

void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  ++allocations;
  return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** result, std::size_t alignment, std::size_t size) {
  ++allocations;
  *result = __libc_memalign(alignment, size);
  return *result == nullptr ? ENOMEM : 0;
}

}  // extern "C"

#endif
