// Writes a file so that a reader finds all of it or none: under a temporary name first, then renamed.
// Throws ConfigError where the folder cannot be made or the disk does not take the bytes.
#pragma once

#include <filesystem>
#include <string_view>

namespace biopsy::report {

void atomic_write(const std::filesystem::path& path, std::string_view bytes);

}  // namespace biopsy::report
