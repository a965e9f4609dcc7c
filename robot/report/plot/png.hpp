// A Picture as PNG: the same picture always gives the same bytes (no time stamp, fixed compression).
#pragma once

#include <filesystem>
#include <string>

#include "robot/common/picture.hpp"

namespace biopsy::report {

// Grey pictures are stored with one channel. Empty for an empty picture; rgb must hold 3 * width * height
// bytes.
std::string png_bytes(const Picture& picture);
void save_png(const Picture& picture, const std::filesystem::path& path);

// "data:image/png;base64,...", to put a picture inside a page.
std::string png_data_uri(const Picture& picture);

}  // namespace biopsy::report
