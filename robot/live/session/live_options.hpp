// Options of a live robot: bus, keys, hardware.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace biopsy::robot {

// SCHED_FIFO priority of the processes in the loop, where permitted: below the interlock's 80.
inline constexpr int kLoopPriority = 60;

// Discovery and authentication of the processes.
struct LiveOptions {
  std::uint32_t domain = 0;
  std::filesystem::path keys;     // empty: the default set, or in a rehearsal one made for it
  bool without_security = false;  // simulated stage only
  std::string network;            // interface; empty: this machine only
  int fifo_priority = kLoopPriority;
  bool separate_users = false;   // an installed system: each process writes into a folder of its own
  std::filesystem::path faults;  // of the simulated stage; empty: none
};

// Additional inputs of a hardware stage.
struct HardwareOptions {
  std::filesystem::path config;         // channels and scales (TOML)
  std::filesystem::path commissioning;  // folder of its commissioning record
};

}  // namespace biopsy::robot
