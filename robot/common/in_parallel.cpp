#include "robot/common/in_parallel.hpp"

#include <tbb/parallel_for.h>

#include <atomic>
#include <exception>
#include <mutex>

namespace biopsy {

void in_parallel(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> failed{count};  // lowest index that threw
  std::exception_ptr failure;
  std::mutex mutex;
  const auto run = [&](std::size_t i) {
    if (i > failed) return;  // those below still run: which failure is reported must not depend on timing
    try {
      work(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (i < failed) failed = i, failure = std::current_exception();
    }
  };
  tbb::parallel_for(std::size_t{0}, count, run, tbb::simple_partitioner());
  if (failure) std::rethrow_exception(failure);
}

}  // namespace biopsy
