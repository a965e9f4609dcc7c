// The stage devices by name: the one place that knows which there are. To add one: a name here, its driver in
// a folder beside nidaqmx/, a row in needle_stage_factory.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "drivers/hardware_needle_stage.hpp"
#include "drivers/pulse_output.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::drivers {

// As typed after --device, in live.json and in the record of commissioning. The first is the simulated stage,
// which is no driver: sim/simulated_stage.hpp.
inline constexpr std::array<std::string_view, 2> kStageDevices{"sim", "nidaqmx"};

inline bool is_simulated(std::string_view device) {
  return device == kStageDevices[0];
}

// Throws ConfigError naming `where` for a name that is none.
inline void check_stage_device(const std::string& device, const std::string& where) {
  if (std::ranges::find(kStageDevices, device) != kStageDevices.end()) return;
  std::string names;
  for (const std::string_view name : kStageDevices) names += (names.empty() ? "" : ", ") + std::string(name);
  throw ConfigError("there is no device \"" + device + "\"", where, "choose from " + names);
}

// Opens the device as its configuration file says. Throws ConfigError, also for the simulated stage.
std::unique_ptr<HardwareNeedleStage> make_hardware_stage(const std::string& device,
                                                         const std::filesystem::path& config);

// The supervisor's line to its half of the interlock. Throws ConfigError where the configuration has none.
std::unique_ptr<PulseOutput> make_supervisor_pulse(const std::string& device,
                                                   const std::filesystem::path& config);

}  // namespace biopsy::drivers
