// The folder a run writes to.
#pragma once

#include <filesystem>
#include <vector>

namespace biopsy {

using Inputs = std::vector<std::filesystem::path>;  // files and folders a run reads; empty paths are none

// Throws ConfigError where an input is the folder, or lies where a run into it clears and writes.
void keep_apart(const std::filesystem::path& folder, const Inputs& inputs);

// Makes the folder ready for a run: creates it, or clears what an earlier run left in it. Only folders this
// function marked before are cleared; in a folder that is not empty and not ours, or that holds an input,
// nothing is touched. Throws ConfigError.
void claim_run_folder(const std::filesystem::path& folder, const Inputs& inputs);

}  // namespace biopsy
