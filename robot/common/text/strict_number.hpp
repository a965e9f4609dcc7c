// Text as a number, all of it or nothing: "0,5", "1.5mm", "nan" and "" are not numbers.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace biopsy {

std::string_view trimmed(std::string_view text);  // without white space and zero bytes at both ends

std::optional<double> strict_number(std::string_view text);  // finite
std::optional<std::int64_t> strict_integer(std::string_view text);

// Numbers between separators, "0.5\0.5" with '\\'; nothing if one of them is not a number. Runs of blanks
// count as one separator.
std::optional<std::vector<double>> strict_numbers(std::string_view text, char separator);

}  // namespace biopsy
