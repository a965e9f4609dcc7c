// Depth checks whose two images are two real scans of one patient, with a needle of known tip in one of them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "tests/planner/imaging/rescan/painted_needle.hpp"

namespace biopsy::imaging::rescan {

// What is wrong with the plan, or with the images. A planned depth that is wrong needs no images of its own:
// it is unknown to what reads them. The numbers seed the draws.
enum class Kind {
  RightPlan = 0,
  Beside5mm = 3,  // the needle is 5 mm beside the planned axis
  Tilted6deg,
  NoNeedle,
  OtherPatient,  // the image before is a liver's
  Swapped,       // the image with the needle is given as the one before
  OldTrack,      // right plan; an old track beside the needle, in both images
};
std::string_view label(Kind kind);

struct Pair {
  std::string name;
  Volume before, after;  // neither has a needle
};

// A pair of ../shared/data/images/mr: "rescan" (guidance scan and its re-scan), "rescan_back" (the other
// way), "planning" (planning scan, then guidance); or "brain", one head imaged twice by echo-planar imaging,
// 2 x 2 x 2.2 mm, oblique (the example of nibabel; Debian: python3-nibabel). nullopt where the images are
// absent.
std::optional<Pair> real_pair(std::string_view name);

struct RescanCase {
  PaintedNeedle needle;
  Volume before, after;
  Point plan_p_SE = Point::Zero();
  Direction plan_axis_S = Direction::UnitZ();
  double plan_depth_mm = 0.0;
};

// Number `seed` of the kind: tip 4 to 12 or 20 to 45 mm deep, within 10 degrees of one of the after image's
// axes, through tissue. nullopt where no such path was found.
std::optional<RescanCase> drawn(const Pair& pair, Kind kind, std::uint64_t seed);

// What figures to the last verdict depend on: OpenCV, and the widest vectors that it filters with here.
std::string opencv_in_use();

}  // namespace biopsy::imaging::rescan
