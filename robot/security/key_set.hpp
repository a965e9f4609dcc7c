// The keys of several roles together: each valid, and all of one set.
#pragma once

#include <chrono>
#include <filesystem>
#include <span>
#include <vector>

#include "robot/security/check_keys.hpp"

namespace biopsy::security {

// A machine may hold the folders of some roles only.
std::vector<Role> roles_present(const std::filesystem::path& folder);

// inspect_keys of every role given, and of the signing keys that are present. A CA that differs from that of
// the first role is a problem: participants of the two would not authenticate each other.
std::vector<FileVerdict> inspect_set(const std::filesystem::path& folder, std::span<const Role> roles,
                                     std::chrono::sys_seconds now);

// Throws ConfigError with the first problem.
void check_set(const std::filesystem::path& folder, std::span<const Role> roles,
               std::chrono::sys_seconds now);

}  // namespace biopsy::security
