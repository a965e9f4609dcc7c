// Replaces a model file and keeps the old version beside it.
#pragma once

#include <filesystem>
#include <string>

namespace biopsy::robot {

// The old version becomes NAME.toml.1, .2, ... (the first free number); returns its path. Atomic: a reader
// finds the old file or the new one. A link is followed: the file behind it is replaced. Throws ConfigError,
// with nothing changed, where the new text is no model or the file cannot be replaced.
std::filesystem::path accept_model(const std::filesystem::path& model_file, const std::string& new_text);

// Throws the ConfigError that accept_model would throw because of the file.
void refuse_unless_replaceable(const std::filesystem::path& model_file);

}  // namespace biopsy::robot
