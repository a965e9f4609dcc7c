// Any bytes as a file of points: points of a scanner's field, or a refusal.
#pragma once

#include "planner/plan/markups/markups_file.hpp"
#include "tests/verification/fuzz/target.hpp"

namespace biopsy::fuzz {

inline void read_points(const std::string& name, Bytes bytes) {
  reads_or_refuses([&] {
    const auto points = planner::parse_markups(text_of(bytes), name);
    for (const planner::MarkupPoint& point : points)
      claim(!point.p_S || point.p_S->cwiseAbs().maxCoeff() <= 2000.0, "a point lies in a scanner");
    if (!points.empty()) planner::point_labelled(points, points.front().label, name);
  });
}

}  // namespace biopsy::fuzz
