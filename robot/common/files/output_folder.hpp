// The folder a command writes to.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace biopsy {

using Inputs = std::vector<std::filesystem::path>;  // files and folders that are read; empty paths are none
using FileNames = std::vector<std::string>;         // in a folder; one * stands for any text

// Throws ConfigError where an input is the folder itself, or lies under one of `names` in it.
void keep_apart(const std::filesystem::path& folder, const Inputs& inputs, const FileNames& names);

// keep_apart, and makes the folder. Throws ConfigError where nothing can be written to it.
void make_output_folder(const std::filesystem::path& folder, const Inputs& inputs, const FileNames& names);

// The same for a run that replaces an earlier one: files of `names` are removed. Only folders that an earlier
// run marked are cleared; a folder that holds other files is refused, and nothing in it is touched.
void claim_run_folder(const std::filesystem::path& folder, const Inputs& inputs, const FileNames& names);

}  // namespace biopsy
