#include "robot/procedure/images/slice_geometry.hpp"

#include "robot/procedure/images/anatomical_orientation.hpp"

namespace biopsy::robot {

report::SliceGeometry geometry_of(const imaging::NeedleSlice& slice) {
  // The report counts pixels from the corner of the first one, the slice from its centre.
  report::SliceGeometry geometry{slice.entry_px.x() + 0.5, slice.entry_px.y() + 0.5, slice.axis_px.x(),
                                 slice.axis_px.y(), slice.mm_per_pixel};
  const Direction right_S = slice.axis_px.x() * slice.frame.along + slice.across_px.x() * slice.frame.across;
  const Direction down_S = slice.axis_px.y() * slice.frame.along + slice.across_px.y() * slice.frame.across;
  geometry.right = anatomical_directions(right_S);
  geometry.left = anatomical_directions(-right_S);
  geometry.bottom = anatomical_directions(down_S);
  geometry.top = anatomical_directions(-down_S);
  return geometry;
}

}  // namespace biopsy::robot
