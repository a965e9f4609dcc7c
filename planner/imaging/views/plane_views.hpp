// The three planes of the body through a point, as radiologists expect them.
#pragma once

#include <array>
#include <string>

#include "planner/imaging/registration/reslice.hpp"

namespace biopsy::imaging {

// Radiological convention: the patient's right is at the left of axial and coronal pictures, anterior at the
// top of axial and at the left of sagittal ones, superior at the top of the others. A point p_S is at pixel
// 0.5 (size - 1) + ((p_S - centre).right, (p_S - centre).down) / mm_per_pixel.
struct PlaneView {
  std::string name;  // "axial", "coronal", "sagittal"
  Picture picture;
  GreyWindow window;  // values that are black and white, in the volume's units
  Point centre_S = Point::Zero();
  Direction right_S = Direction::UnitX(), down_S = Direction::UnitY();
  int slice = 0, slices = 0;  // of the volume, from 1, where the plane is one of its own; 0: oblique to them

  Eigen::Vector2d pixel(const Point& p_S) const;
  std::string coordinate() const;  // the one that all points of the plane share: "S 51.9 mm"
};

// Planes through `p_S`, squares of side `extent`; black where there is no image.
std::array<PlaneView, 3> plane_views(const Volume& volume, const Point& p_S, Millimetres extent);

}  // namespace biopsy::imaging
