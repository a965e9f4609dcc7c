// Plain text in lines and columns. Widths count the characters that a terminal shows, not the bytes of their
// UTF-8.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace biopsy {

std::size_t display_width(std::string_view text);

// Filled with blanks up to `width` characters.
std::string padded_right(const std::string& text, std::size_t width);
std::string padded_left(const std::string& text, std::size_t width);

// Lines of at most `width` characters, broken at blanks; a longer word has a line of its own.
std::vector<std::string> wrapped(std::string_view text, std::size_t width);

// At most `most` characters, the last of them "…" where something was left out.
std::string shortened(const std::string& text, std::size_t most);

// "a, b and c": `between` the parts, `last` before the last one.
std::string joined(const std::vector<std::string>& parts, std::string_view between = ", ");
std::string joined(const std::vector<std::string>& parts, std::string_view between, std::string_view last);

}  // namespace biopsy
