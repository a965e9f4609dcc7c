#include "robot/live/processes/commissioned_stage.hpp"

#include <chrono>

#include "drivers/commissioning/load_commissioning.hpp"
#include "drivers/needle_stage_factory.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/sha256.hpp"
#include "robot/common/text/encoding.hpp"

namespace biopsy::robot {

std::unique_ptr<drivers::HardwareNeedleStage> open_commissioned_stage(
    const std::string& device, const std::filesystem::path& config,
    const std::filesystem::path& commissioning, const std::filesystem::path& public_key) {
  auto stage = drivers::make_hardware_stage(device, config);
  commissioning::load_commissioning(commissioning, public_key, {device, stage->product(), stage->serial()},
                                    hex(sha256(read_file(config))), std::chrono::system_clock::now());
  if (!stage->has_panel())
    throw ConfigError("no keys and no emergency stop are wired", config.string(),
                      "wire them and add [panel]: arming takes a key on the device");
  if (!stage->has_relay_contact())
    throw ConfigError(
        "the interlock's relay is not read back", config.string(),
        "wire its feedback contact and add [relay_contact]: a relay that does not open must be seen");
  return stage;
}

}  // namespace biopsy::robot
