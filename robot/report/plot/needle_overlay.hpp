// Pictures of the needle for people: the grey slice with drawings on top, as an SVG that holds the PNG. Entry
// cyan ring, target magenta cross, path yellow, layer boundaries as ticks with name and mm, scale bar. Left
// the whole slice, right the path enlarged, because a path of a few millimetres is a few pixels.
#pragma once

#include <string>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

struct OverlayText {
  std::string title;  // for screen readers
  std::string note;   // printed into the picture: "SIMULATED"
};

// Empty for an empty picture. Throws nothing; geometry.mm_per_pixel must be above zero.
std::string planning_overlay(const Picture& slice, const SliceGeometry& geometry, const Plan& plan,
                             const OverlayText& text);

// The enlarged path alone, from the entry down to `shown`, so that before and after have one scale: the depth
// as planned (magenta cross) and, where `check` holds a tip, the tip as found (white dot with a bar of +- 2
// standard deviations), with the void's end and the offset that was taken off it in words. `check` is null
// for the image before.
struct TipDepths {
  Millimetres planned, shown;
  const DepthCheck* check = nullptr;
};
std::string tip_overlay(const Picture& slice, const SliceGeometry& geometry, const TipDepths& depths,
                        const OverlayText& text);

// The part of `picture` from (x, y) on; black where it reaches beyond the edge.
Picture cropped(const Picture& picture, int x, int y, int width, int height);

}  // namespace biopsy::report
