#include "robot/common/typed_point.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "robot/common/config_error.hpp"

namespace biopsy::robot {

Point typed_point(const std::string& option, const std::string& text) {
  const auto refuse = [&](const std::string& why) {
    throw ConfigError(fmt::format("\"{}\" {}", text, why), option,
                      "type three numbers in mm, e.g. 12.5,-30,48.25 (right, anterior, superior)");
  };
  Eigen::Vector3d ras;
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  for (int i = 0; i < 3; ++i) {
    while (at != end && *at == ' ') ++at;
    if (at != end && *at == '+') ++at;
    const auto [stop, error] = std::from_chars(at, end, ras[i]);
    if (error != std::errc() || !std::isfinite(ras[i])) refuse("is not R,A,S");
    if (std::abs(ras[i]) > 2000.0) refuse("lies more than 2 m from the scanner's centre");
    at = stop;
    while (at != end && *at == ' ') ++at;
    if (i < 2 && (at == end || *at++ != ',')) refuse("is not R,A,S");
  }
  if (at != end) refuse("has more than three numbers");
  return lps_from_ras(ras);
}

}  // namespace biopsy::robot
