// Whole files: read at once, written so that a reader finds the old content or the new one.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace biopsy {

// All bytes. Throws ConfigError, with `remedy` as what to do, where the file is missing, cannot be read or
// has more than 1 GB.
std::string read_file(const std::filesystem::path& file,
                      const std::string& remedy = "check the path and the permissions");

// The same where a missing file is no mistake: "".
std::string read_file_if_present(const std::filesystem::path& file);

// Written under a temporary name in the same folder, which is made if it is missing, then renamed. Throws
// ConfigError where that fails; what was there before then stays.
void atomic_write(const std::filesystem::path& file, std::string_view bytes);

}  // namespace biopsy
