// Points as people type them: "R,A,S" in millimetres.
#pragma once

#include <string>

#include "robot/common/frames.hpp"

namespace biopsy::robot {

// Returns LPS. Throws ConfigError naming `option` where the text is not three finite numbers within 2 m.
Point typed_point(const std::string& option, const std::string& text);

}  // namespace biopsy::robot
