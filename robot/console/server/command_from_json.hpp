// A message of the page, read strictly: one object of module `ask`, nothing missing, unknown or out of range.
#pragma once

#include <console_messages.hpp>  // generated from idl/console.idl
#include <string>

namespace biopsy::console {

// Throws MessageFault, saying what is wrong.
ask::Any ask_from_json(const std::string& text);

}  // namespace biopsy::console
