// Arming on hardware requires the commissioning record of this very stage, not older than a year.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "drivers/commissioning/record.hpp"

namespace biopsy::commissioning {

inline constexpr const char* kRecordFile = "commissioning.json";
inline constexpr const char* kSignatureFile =
    "commissioning.sig";  // 64 bytes, Ed25519 over the record's bytes
// Calibration interval of test equipment: lasers drift, contacts wear.
inline constexpr std::chrono::days kGoodFor{365};

// The record in `folder`, if it was signed with the key that belongs to `public_key`, is of this device and
// of this configuration (SHA-256, as hex, of the file's bytes), passed every step of this program, and is not
// older than a year. Throws ConfigError for everything else.
Record load_commissioning(const std::filesystem::path& folder, const std::filesystem::path& public_key,
                          const Device& device, const std::string& config_sha256,
                          std::chrono::system_clock::time_point now);

}  // namespace biopsy::commissioning
