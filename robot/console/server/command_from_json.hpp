// A message of the page, read strictly: one object of module `commands`, nothing missing, unknown or out of
// range.
#pragma once

#include <console_messages.hpp>  // generated from idl/console.idl
#include <string>

namespace biopsy::console {

// Throws MessageFault, saying what is wrong.
commands::Any command_from_json(const std::string& text);

}  // namespace biopsy::console
