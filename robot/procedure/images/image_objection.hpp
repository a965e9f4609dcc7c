// Whether an image that arrived can be the confirmation of this needle in this patient.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "planner/imaging/io/watched_folder.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::robot {

// What is known when an image is expected; times by the clock of this machine.
struct ExpectedImage {
  SeriesIdentity planning;
  std::chrono::system_clock::time_point arrived;  // since then the needle is where it is
  std::chrono::system_clock::time_point now;
  std::optional<std::chrono::system_clock::time_point> last_acquired;  // of the confirmation before
  std::string confirmed_by;  // a person who answers for images that do not name their patient; empty: nobody
};

// The scanner's clock may be ahead of this machine's by this much. Nothing is allowed in the other direction:
// an image that was begun before the needle arrived shows it at an earlier place.
inline constexpr std::chrono::seconds kClockTolerance{2};

// One sentence, or nothing where there is no objection: another patient or frame of reference, the planning
// series itself, simulated or derived images, a localiser, acquired or written before the needle arrived,
// before the confirmation before it, or in the future; without a time or an identity that nobody answers for.
std::string image_objection(const imaging::IncomingSeries& image, const ExpectedImage& expected);

}  // namespace biopsy::robot
