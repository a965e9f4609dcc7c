// Numbers that rise from start to start of a process, whatever is done to the wall clock.
#pragma once

#include <cstdint>
#include <filesystem>

namespace biopsy::live {

// Larger than any that `file` has given before, and the seconds since 1970 where that is larger still. The
// file is written as a whole. Throws ConfigError where it cannot be, or where it holds no number.
std::uint32_t monotonic_session_id(const std::filesystem::path& file);

}  // namespace biopsy::live
