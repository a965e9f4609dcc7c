// Names of attachments and roles, and units of parameters as text.
#pragma once

#include <string>
#include <string_view>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

std::string_view name_of(Attachment attachment);
std::string_view name_of(Role role);

// The unit at the end of a parameter's name: "mm/s" of "speed_mm_s"; empty for a pure number.
std::string unit_of(std::string_view parameter);

}  // namespace biopsy::sim
