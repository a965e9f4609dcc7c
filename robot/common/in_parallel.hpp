// The same work on every index in [0, count), spread over the machine's cores (oneTBB). Each call writes to
// places of its own, so that results do not depend on the number of threads. Calls may be nested.
#pragma once

#include <cstddef>
#include <functional>

namespace biopsy {

// An exception of one call ends the loop: indices above it may be left out, and it is thrown again here, that
// of the lowest index where several fail.
void in_parallel(std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace biopsy
