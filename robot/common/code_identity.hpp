// Which code a piece of evidence is about.
#pragma once

#include <filesystem>
#include <string>

namespace biopsy {

// SHA-256, as hex, over name and content of every file of the tree that a build or a proof is made of:
// sources, build files with their compiler options, scripts, cases, models, expected results; sorted by name.
// Any change of the code makes evidence of before stale. Throws ConfigError where a file cannot be read.
std::string code_fingerprint(const std::filesystem::path& tree);

// The commit that is checked out, with "+" where files differ from it; "unknown" without git.
std::string commit_of(const std::filesystem::path& tree);

std::string utc_now();  // 2031-05-17T09:30:00Z

}  // namespace biopsy
