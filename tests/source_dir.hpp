// Where the source tree and the build tree are. Functions, not macros in every file: one object differs
// between two checkouts, and the compiler cache serves the rest.
#pragma once

#include <filesystem>

namespace biopsy {

std::filesystem::path source_dir();
std::filesystem::path binary_dir();

}  // namespace biopsy
