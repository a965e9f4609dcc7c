// How a live robot is brought up: its bus, its keys, its hardware.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace biopsy::robot {

// SCHED_FIFO of what is in the loop, where permitted: below the interlock's 80.
inline constexpr int kLoopPriority = 60;

// How the processes of a live robot find and trust each other.
struct LiveOptions {
  std::uint32_t domain = 0;
  std::filesystem::path keys;     // empty: the default set, or in a rehearsal one made for it
  bool without_security = false;  // simulated stage only
  std::string network;            // interface; empty: this machine only
  int fifo_priority = kLoopPriority;
};

// What a real stage needs besides.
struct HardwareOptions {
  std::filesystem::path config;         // channels and scales (TOML)
  std::filesystem::path commissioning;  // folder of its commissioning record
};

}  // namespace biopsy::robot
