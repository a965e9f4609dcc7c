#include "robot/live/monotonic_session_id.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <limits>
#include <string>

#include "robot/common/config_error.hpp"

namespace biopsy::live {

namespace {

// Atomic: an interrupted start leaves the old number or the new one.
void keep(const std::filesystem::path& file, std::uint32_t number) {
  const std::filesystem::path beside = file.string() + ".next";
  std::ofstream out(beside);
  out << number << '\n' << std::flush;
  std::error_code failed;
  if (out) std::filesystem::rename(beside, file, failed);
  if (!out || failed)
    throw ConfigError("the number of this start cannot be kept", file.string(),
                      "see that the folder exists and may be written");
}

}  // namespace

std::uint32_t monotonic_session_id(const std::filesystem::path& file) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  std::uint64_t last = 0;
  if (std::filesystem::exists(file)) {
    std::ifstream in(file);
    if (in.peek() == '-' || !(in >> last) || last >= kMost)
      throw ConfigError("holds no number of the last start", file.string(),
                        "remove it once no process of this robot runs any more");
  }
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  const std::int64_t seconds = std::chrono::duration_cast<std::chrono::seconds>(since_1970).count();
  const std::uint64_t wall = static_cast<std::uint64_t>(std::clamp<std::int64_t>(seconds, 1, kMost));
  const auto next = static_cast<std::uint32_t>(std::max(last + 1, wall));
  keep(file, next);
  return next;
}

}  // namespace biopsy::live
