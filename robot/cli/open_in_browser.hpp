// The desktop's browser.
#pragma once

#include <string>

namespace biopsy::robot {

// Returns at once. Where there is no desktop nothing happens: the address is there to be typed.
void open_in_browser(const std::string& url);

}  // namespace biopsy::robot
