// The keys of several roles together: each good, and all of one set.
#pragma once

#include <chrono>
#include <filesystem>
#include <span>
#include <vector>

#include "robot/security/check_keys.hpp"

namespace biopsy::security {

// A machine may hold the folders of some roles only.
std::vector<Role> roles_present(const std::filesystem::path& folder);

// inspect_keys of every role given, and of the signing keys that are there. A CA that is not the one of the
// first role is a problem: these two would never find each other, without a word.
std::vector<FileVerdict> inspect_set(const std::filesystem::path& folder, std::span<const Role> roles,
                                     std::chrono::sys_seconds now);

// Throws ConfigError with the first problem.
void check_set(const std::filesystem::path& folder, std::span<const Role> roles,
               std::chrono::sys_seconds now);

}  // namespace biopsy::security
