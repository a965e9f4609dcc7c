#include "sim/scanner/needle_artefact.hpp"

#include <algorithm>
#include <cmath>

namespace biopsy::sim {
namespace {

// 1 well inside, 0.5 on the border, 0 well outside.
double inside(double depth_mm, Millimetres edge) {
  const double softness = std::max(edge.value, 1e-3);
  return 0.5 * std::erfc(-depth_mm / (std::sqrt(2.0) * softness));
}

}  // namespace

double signal_left(const NeedleArtefact& needle, const Point& p_S) {
  const Eigen::Vector3d d = p_S - needle.p_SE;
  const Direction axis = needle.axis_S.normalized();
  const double along = d.dot(axis);
  const double from_axis = (d - along * axis).norm();
  const double before_tip = needle.tip_depth.value - along;
  const double reach = 4.0 * needle.edge.value;
  if (before_tip < -reach || along < -needle.shaft_behind.value - reach) return 1.0;
  const double near_tip =
      std::exp(-0.5 * std::pow((before_tip - needle.radius.value) / needle.radius.value, 2));
  const double radius = needle.radius.value * (1.0 + needle.tip_bloom * near_tip);
  if (from_axis > radius + reach) return 1.0;
  const double rim = std::min(from_axis / radius, 1.0);
  const double rounding = needle.tip_roundness * radius * (1.0 - std::sqrt(1.0 - rim * rim));
  const double covered = inside(radius - from_axis, needle.edge) *
                         inside(before_tip - rounding, needle.edge) *
                         inside(along + needle.shaft_behind.value, needle.edge);
  // A thin soft void never reaches its full loss on the centreline; the half-signal point must stay at the
  // tip.
  const double core = inside(radius, needle.edge);
  return 1.0 - needle.loss * std::min(covered / core, 1.0);
}

double signal_left(const TissueVoid& trace, const Point& p_S) {
  const Eigen::Vector3d length = trace.p_SB - trace.p_SA;
  const double squared = length.squaredNorm();
  const double where = squared > 0.0 ? std::clamp((p_S - trace.p_SA).dot(length) / squared, 0.0, 1.0) : 0.0;
  const double distance = (p_S - trace.p_SA - where * length).norm();
  return 1.0 - trace.loss * inside(trace.radius.value - distance, trace.edge);
}

}  // namespace biopsy::sim
