// Reads the configuration's files again while the robot runs: what would be armed must still be what was
// started.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <thread>

#include "robot/live/live_settings.hpp"

namespace biopsy::live {

// The tag of the files as last read, handed from the thread that reads to a loop that must not wait for a
// disk.
class FilesTag {
 public:
  static constexpr std::int64_t kRead_us = 5'000'000;

  // `tag`: 0 where a file could not be read. Times: CLOCK_MONOTONIC, us.
  void set(std::uint64_t tag, std::int64_t read_us) {
    tag_.store(tag, std::memory_order_relaxed);
    read_us_.store(read_us, std::memory_order_release);
  }
  // 0 where it is not known: never read, or not since kRead_us before `now_us`.
  std::uint64_t at(std::int64_t now_us) const {
    const std::int64_t read_us = read_us_.load(std::memory_order_acquire);
    const bool fresh = read_us != 0 && now_us - read_us <= kRead_us;
    return fresh ? tag_.load(std::memory_order_relaxed) : 0;
  }
  // When the reading of the present tag began; 0: never.
  std::int64_t read_us() const { return read_us_.load(std::memory_order_acquire); }

  // Asks for a new reading; costs a loop nothing. Whoever reads asks whether it was asked for, once.
  void ask() const { asked_.store(true, std::memory_order_relaxed); }
  bool take_request() const { return asked_.exchange(false, std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> tag_{0};
  std::atomic<std::int64_t> read_us_{0};
  mutable std::atomic<bool> asked_{false};
};

// Keeps a FilesTag up to date, twice a second and where it is asked for, on a thread with ordinary
// scheduling.
class ConfigWatch {
 public:
  ConfigWatch(std::filesystem::path run_folder, LiveSettings settings);

  const FilesTag& files() const { return files_; }
  // Reads now.
  void read(std::int64_t now_us);

 private:
  std::filesystem::path run_folder_;
  LiveSettings settings_;
  FilesTag files_;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace biopsy::live
