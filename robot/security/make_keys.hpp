// Makes a complete key set: CAs, an identity and permissions for each role, the pairs that sign logs.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include "robot/security/grants.hpp"

namespace biopsy::security {

inline constexpr int kLeastDays = 1, kMostDays = 3650;

struct MadeKeys {
  Validity validity;
  std::optional<std::filesystem::path> old_set;  // where the replaced set is now
};

// Valid from an hour before `now` (clocks of two machines differ) for `days`. Afterwards the set is complete,
// or everything is as it was and ConfigError is thrown. An existing set is refused, or with `replace` moved
// to FOLDER.<time>; a folder that holds anything else is always refused.
MadeKeys make_keys(const std::filesystem::path& folder, int days, std::chrono::sys_seconds now, bool replace);

}  // namespace biopsy::security
