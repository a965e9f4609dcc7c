// Gains of the PI loop as a `[controller]` table: in a case, or as the file that `biopsy tune` writes.
#pragma once

#include <filesystem>
#include <string>

#include "robot/msg/plan.hpp"

namespace biopsy {
class TomlTable;
}

namespace biopsy::robot {

// Throw ConfigError naming file and line where a gain is missing or not permitted.
PiGains read_controller(TomlTable table);
PiGains read_controller_file(const std::filesystem::path& file);

// `title` says where the gains come from.
std::string controller_toml(const PiGains& gains, const std::string& title);

}  // namespace biopsy::robot
