// Numbers for people and files: fixed rounding, never "-0.00", never NaN.
#pragma once

#include <string>

namespace biopsy {

// Rounded to `decimals`; minus zero becomes zero.
double rounded(double value, int decimals);

// "3.51"; an en dash where the number is unknown (not finite).
std::string fixed(double value, int decimals);

// "1 file", "2 files": the number and the noun, with an s unless there is one.
std::string counted(std::size_t count, const std::string& noun);

// "3.51 mm", or an en dash alone.
std::string fixed(double value, int decimals, const std::string& unit);

}  // namespace biopsy
