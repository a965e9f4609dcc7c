// Puts a new text in the place of a model file and keeps the old one beside it.
#pragma once

#include <filesystem>
#include <string>

namespace biopsy::robot {

// The old version becomes NAME.toml.1, .2, ... (the first free number); returns its path. A reader finds the
// old file or the new one, never a part. Throws ConfigError, with everything as it was, where the new text is
// no model or the file cannot be replaced. A link is followed: the file behind it is replaced.
std::filesystem::path accept_model(const std::filesystem::path& model_file, const std::string& new_text);

// Throws the ConfigError that accept_model would throw because of the file, before any work is done.
void refuse_unless_replaceable(const std::filesystem::path& model_file);

}  // namespace biopsy::robot
