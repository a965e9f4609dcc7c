#include "robot/common/text/ras_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/config_error.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy {

Point parse_ras_point(const std::string& option, const std::string& text) {
  constexpr double kFar_mm = 2000.0;  // no scanner's field is wider
  const auto refuse = [&](const char* why) {
    throw ConfigError(fmt::format("\"{}\" {}", text, why), option,
                      "type three numbers in mm, e.g. 12.5,-30,48.25 (right, anterior, superior)");
  };
  const auto ras = strict_numbers(text, ',');
  if (!ras || ras->size() < 3) refuse("is not R,A,S");
  if (ras->size() > 3) refuse("has more than three numbers");
  if (std::ranges::any_of(*ras, [](double x) { return std::abs(x) > kFar_mm; }))
    refuse("lies more than 2 m from the scanner's centre");
  return lps_from_ras({(*ras)[0], (*ras)[1], (*ras)[2]});
}

}  // namespace biopsy
