#include "drivers/needle_stage_factory.hpp"

#include "drivers/nidaqmx/nidaqmx_stage.hpp"
#include "drivers/nidaqmx/pulse_line.hpp"

namespace biopsy::drivers {
namespace {

namespace fs = std::filesystem;

struct HardwareDriver {
  std::string_view device;
  std::unique_ptr<HardwareNeedleStage> (*make_stage)(const fs::path& config);
  std::unique_ptr<PulseOutput> (*make_supervisor_pulse)(const fs::path& config);
};

constexpr std::array<HardwareDriver, kStageDevices.size() - 1> kDrivers{{
    {"nidaqmx",
     [](const fs::path& config) -> std::unique_ptr<HardwareNeedleStage> {
       return std::make_unique<nidaqmx::NidaqmxStage>(nidaqmx::read_config(config));
     },
     [](const fs::path& config) -> std::unique_ptr<PulseOutput> {
       return std::make_unique<nidaqmx::PulseLine>(nidaqmx::read_config(config));
     }},
}};

const HardwareDriver& driver_of(const std::string& device) {
  const auto* driver = std::ranges::find(kDrivers, device, &HardwareDriver::device);
  if (driver == kDrivers.end())
    throw ConfigError("there is no driver for the device \"" + device + "\"", "--device", "choose nidaqmx");
  return *driver;
}

}  // namespace

std::unique_ptr<HardwareNeedleStage> make_hardware_stage(const std::string& device, const fs::path& config) {
  return driver_of(device).make_stage(config);
}

std::unique_ptr<PulseOutput> make_supervisor_pulse(const std::string& device, const fs::path& config) {
  return driver_of(device).make_supervisor_pulse(config);
}

}  // namespace biopsy::drivers
