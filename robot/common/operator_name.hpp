// Who operates this program, for logs and reports: BIOPSY_OPERATOR of the environment, else the user's login
// name. A claim, not a proof: what is proven is the identity of the process, by its keys.
#pragma once

#include <string>

namespace biopsy {

// At most 100 bytes of UTF-8, printable; "unknown" where neither is there.
std::string operator_name();

}  // namespace biopsy
