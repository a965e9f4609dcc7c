// The independent interlock on the simulated digital I/O: safety/interlock.hpp, fed by the pulse counters.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

#include "drivers/digital_io/io_views.hpp"
#include "safety/interlock.hpp"

namespace biopsy::digital_io {

// Twice as fast as the pulses.
inline constexpr std::chrono::microseconds kRelayPeriod{500};
// How late a tick may come and still open the relay in time: a process without a real-time scheduler is now
// and then.
inline constexpr std::chrono::microseconds kRelayLate = kRelayPeriod;

// Times: CLOCK_MONOTONIC, ns. Starts open, and only pulses from now on count.
class InterlockRelay {
 public:
  // Throws ConfigError, see IoFile.
  InterlockRelay(const std::filesystem::path& folder, std::int64_t now_ns);

  // To be called every kRelayPeriod. A counter that changed since the last tick counts as a pulse at the time
  // of the last tick, the earliest possible: after a stall of this process it is as old as the stall is long.
  // The relay closes only if it may stay closed until the next tick, be that late by kRelayLate. So no tick
  // that is no later exceeds 20 ms; up to two periods of them and kRelayLate are lost.
  void tick(std::int64_t now_ns);

  // Opens and discards all pulses so far: before the process ends.
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
