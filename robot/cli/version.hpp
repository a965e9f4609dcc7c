// What `biopsy --version` prints.
#pragma once

#include <string>

namespace biopsy::robot {

// Version, commit of the build ("+" where files differed from it) and the libraries as they are linked.
std::string version_text();

}  // namespace biopsy::robot
