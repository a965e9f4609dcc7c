// Reads the needle's depth from a new image, compared with the one before, and says whether it is where it
// should be.
#pragma once

#include <span>

#include "planner/imaging/depth_check/depth_verdict.hpp"
#include "planner/imaging/registration/reslice.hpp"
#include "robot/msg/depth_check.hpp"

namespace biopsy::imaging {

// Both images in one plane through the needle's axis, the before image moved onto the after image and shown
// in the same greys.
struct DepthCheckPictures {
  NeedleSlice before, after;  // the tip is marked in `after.picture` where one was found
  Eigen::Vector2d tip_px = Eigen::Vector2d::Zero();
};

// The images' part: motion of the patient and end of the void. No planned depth comes in here.
DepthReading read_depth(const Volume& before, std::span<const Volume> after, const NeedleFrame& frame,
                        Millimetres depth_max);

// p_SE: entry, axis_S: insertion, both in the scanner frame of the after image, where the robot holds the
// needle; the patient may have moved by up to 12 mm and 12 degrees. The images may differ in grid, noise and
// brightness. Knows nothing of the laser. Throws ConfigError: no axis, numbers not finite, an empty image,
// entry outside both images.
//
// `after`: a volume, or several stacks that were taken together, each of any number of slices: three
// orthogonal planes, a slab. The picture is cut through the one that shows most of the path.
DepthCheck check_depth(const Volume& before, std::span<const Volume> after, const Point& p_SE,
                       const Direction& axis_S, const DepthCheckSettings& settings = {},
                       DepthCheckPictures* pictures = nullptr);
inline DepthCheck check_depth(const Volume& before, const Volume& after, const Point& p_SE,
                              const Direction& axis_S, const DepthCheckSettings& settings = {},
                              DepthCheckPictures* pictures = nullptr) {
  return check_depth(before, std::span(&after, 1), p_SE, axis_S, settings, pictures);
}

}  // namespace biopsy::imaging
