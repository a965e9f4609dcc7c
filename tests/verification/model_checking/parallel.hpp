// Independent jobs on two threads, each job once; the first exception of a job is thrown again here.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>

namespace biopsy::explore {

template <class Job>
void in_parallel(std::size_t jobs, Job&& job) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex mutex;
  const auto work = [&] {
    for (std::size_t i = next++; i < jobs; i = next++) try {
        job(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        next = jobs;
      }
  };
  {
    const std::jthread second(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace biopsy::explore
