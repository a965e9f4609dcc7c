// A record in words, for a person who reads the log. What is hashed is the record's body, not this.
#pragma once

#include <string>

#include "robot/recorder/record.hpp"

namespace biopsy::recorder {

// One line. A body that is not what its kind has is returned as it stands.
std::string text_of(const Record& record);

}  // namespace biopsy::recorder
