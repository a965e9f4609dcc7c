// What the operator chose on the image.
#pragma once

#include <string>

#include "robot/common/frames.hpp"

namespace biopsy {

struct Target {
  std::string patient_id;
  std::string series_uid;      // the image the points were picked on
  Point p_SE = Point::Zero();  // entry: needle tip at displacement zero, LPS mm
  Point p_ST = Point::Zero();  // target, LPS mm
};

}  // namespace biopsy
