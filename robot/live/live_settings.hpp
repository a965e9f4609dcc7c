// Settings of the live robot; every process reads them once, at its start, from the run folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "drivers/needle_stage_factory.hpp"
#include "robot/msg/plan.hpp"

namespace biopsy::live {

struct LiveSettings {
  std::uint32_t domain = 0;                       // of DDS, 0 to 230
  std::uint32_t robot = 1;                        // whose messages
  std::filesystem::path keys;                     // folder of `biopsy keys init`; empty: without security
  std::string network;                            // interface; empty: loopback
  std::string device{drivers::kStageDevices[0]};  // one of kStageDevices
  std::filesystem::path device_config;            // of the hardware,
  std::filesystem::path commissioning;            // the folder of its commissioning record,
  std::filesystem::path commissioning_key;        // and the public key that this is signed with
  std::filesystem::path log;                      // the procedure log; relative: in the recorder's own folder
  std::filesystem::path log_key;                  // private key that signs it (PEM)
  std::filesystem::path lines;                    // folder of the simulated digital I/O, in memory
  int fifo_priority = 0;  // SCHED_FIFO of the control processes, 0 to 90; 0: ordinary scheduling
  // of the simulated stage
  std::filesystem::path model, tissues;
  std::filesystem::path faults;  // that are put into it; empty: none
  double weight_g = 50.0;
  std::uint64_t seed = 1;
  std::vector<Layer> layers;  // along the needle's path
};

// Where a process keeps what it writes: the folder that systemd made for it alone (StateDirectory=), else the
// run folder.
std::filesystem::path own_folder(const std::filesystem::path& run_folder);

// live.json in the run folder.
std::filesystem::path settings_file(const std::filesystem::path& run_folder);

std::string to_json(const LiveSettings& settings);
// Throws ConfigError for a missing file, an unknown name, a value out of range.
LiveSettings read_settings(const std::filesystem::path& run_folder);
LiveSettings parse_settings(const std::string& text, const std::string& name);

// Identifies the configuration: first 8 bytes of the SHA-256 over the settings and every file they name,
// except keys, log and lines. Each process computes it from the files; never 0. Throws ConfigError where a
// file cannot be read.
std::uint64_t config_tag(const std::filesystem::path& run_folder, const LiveSettings& settings);

}  // namespace biopsy::live
