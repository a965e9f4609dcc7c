#include "robot/common/text/number_text.hpp"

#include <fmt/format.h>

#include <cmath>

namespace biopsy {

double rounded(double value, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::round(value * scale) / scale + 0.0;  // + 0.0 turns -0.0 into 0.0
}

std::string fixed(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", rounded(value, decimals), decimals) : "–";
}

std::string fixed(double value, int decimals, const std::string& unit) {
  return std::isfinite(value) ? fixed(value, decimals) + " " + unit : "–";
}

std::string counted(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace biopsy
