#include "robot/live/processes/hardware_stage.hpp"

#include <chrono>
#include <fstream>
#include <iterator>
#include <string>

#include "drivers/commissioning/load_commissioning.hpp"
#include "drivers/commissioning/signature.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::robot {
namespace {

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

std::unique_ptr<nidaqmx::NidaqmxStage> commissioned_stage(const std::filesystem::path& config,
                                                          const std::filesystem::path& commissioning,
                                                          const std::filesystem::path& public_key) {
  auto stage = std::make_unique<nidaqmx::NidaqmxStage>(nidaqmx::read_config(config));
  commissioning::load_commissioning(commissioning, public_key, {"nidaqmx", stage->product(), stage->serial()},
                                    commissioning::sha256_hex(bytes_of(config)),
                                    std::chrono::system_clock::now());
  if (!stage->has_panel())
    throw ConfigError("no keys and no emergency stop are wired", config.string(),
                      "wire them and add [panel]: arming takes a key on the device");
  return stage;
}

}  // namespace biopsy::robot
