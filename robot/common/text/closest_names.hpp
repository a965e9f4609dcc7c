// Which known names a mistyped word may have meant.
#pragma once

#include <string>
#include <vector>

namespace biopsy {

// Insertions, deletions, substitutions and swaps of neighbours that make one word of the other (optimal
// string alignment; Damerau 1964).
std::size_t edit_distance(std::string_view a, std::string_view b);

// The closest first: within two edits (a quarter of a longer name), or holding three letters or more that
// were typed. Leading dashes do not count. At most three, or six that hold what was typed.
std::vector<std::string> closest_names(const std::string& typed, const std::vector<std::string>& known);

}  // namespace biopsy
