// Points as people type them: "R,A,S" in millimetres.
#pragma once

#include <string>

#include "robot/common/frames.hpp"

namespace biopsy {

// Returns LPS. Throws ConfigError naming `option` where the text is not three finite numbers within 2 m.
Point parse_ras_point(const std::string& option, const std::string& text);

}  // namespace biopsy
