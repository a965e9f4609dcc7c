// How often `what` stands in a text, without overlaps.
#pragma once

#include <string_view>

namespace biopsy {

inline std::size_t count_of(std::string_view text, std::string_view what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + what.size())) ++found;
  return found;
}

}  // namespace biopsy
