// Makes an empty log with its signed head, and a copy of the public key beside it. It appears under its name
// whole or not at all. Throws ConfigError where the folder cannot be written.
#pragma once

#include <filesystem>

#include "robot/common/ed25519.hpp"

namespace biopsy::recorder {

void make_log(const std::filesystem::path& log, const SigningKey& key);

}  // namespace biopsy::recorder
