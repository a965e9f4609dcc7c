// Figures go to disk whole or not at all.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace biopsy::proof {

// False, with the reason on stderr, where the file cannot be written.
bool write_json(const std::string& file, const nlohmann::json& content);

}  // namespace biopsy::proof
