// The independent interlock on the simulated lines: safety/interlock.hpp, fed by what the pulse counters do.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

#include "drivers/digital_io/io_views.hpp"
#include "safety/interlock.hpp"

namespace biopsy::digital_io {

// Twice as fast as what it listens to.
inline constexpr std::chrono::microseconds kRelayPeriod{500};

// Times: CLOCK_MONOTONIC, ns. Starts open, whatever the relay did in an earlier life, and with the counters
// as it finds them: only pulses from now on count.
class InterlockRelay {
 public:
  // Throws ConfigError, see SharedIo.
  InterlockRelay(const std::filesystem::path& run_folder, std::int64_t now_ns);

  // To be called every kRelayPeriod. A counter that moved since the last tick was fed, one that stands still
  // was not, whatever its value. The feeding is dated to the last tick, the earliest it can have been: a
  // pulse found after a stall of this process counts as old as the stall is long. And it closes only if it
  // may stay closed until the next tick, for it cannot open sooner. So the 20 ms hold to the last, at the
  // price of two periods.
  void tick(std::int64_t now_ns);

  // Opens and forgets all feeding: the last act of a process that ends.
  void open(std::int64_t now_ns);

  bool closed() const { return closed_; }

 private:
  InterlockIo out_;
  IoReader in_;
  safety::Interlock interlock_;
  std::uint64_t stage_pulses_ = 0, supervisor_pulses_ = 0;  // at the last tick
  std::int64_t ticked_us_ = 0;
  bool closed_ = false;
};

}  // namespace biopsy::digital_io
