// Compression of what is sent to browsers.
#pragma once

#include <string>
#include <string_view>

namespace biopsy::console {

// As a gzip file of level 9. Throws ConfigError where memory is short.
std::string gzip(std::string_view bytes);

}  // namespace biopsy::console
