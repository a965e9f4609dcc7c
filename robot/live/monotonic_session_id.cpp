#include "robot/live/monotonic_session_id.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy::live {

std::uint32_t monotonic_session_id(const std::filesystem::path& file) {
  constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
  std::uint64_t last = 0;
  if (!std::filesystem::is_directory(file.parent_path()))  // a new folder would hide the last number
    throw ConfigError("the folder of the last start is not there", file.parent_path().string(),
                      "create the run folder first: biopsy up");
  if (std::filesystem::exists(file)) {
    const auto kept = strict_integer(read_file(file));
    if (!kept || *kept < 0 || *kept >= kMost)
      throw ConfigError("holds no number of the last start", file.string(),
                        "remove it once no process of this robot runs any more");
    last = static_cast<std::uint64_t>(*kept);
  }
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  const std::int64_t seconds = std::chrono::duration_cast<std::chrono::seconds>(since_1970).count();
  const std::uint64_t wall = static_cast<std::uint64_t>(std::clamp<std::int64_t>(seconds, 1, kMost));
  const auto next = static_cast<std::uint32_t>(std::max(last + 1, wall));
  atomic_write(file, fmt::format("{}\n", next));
  return next;
}

}  // namespace biopsy::live
