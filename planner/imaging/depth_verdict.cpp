#include "planner/imaging/depth_verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace biopsy::imaging {

bool needle_seen(const TipFinding& tip, const DepthCheckSettings& s) {
  return tip.evidence >= s.evidence_min && tip.evidence >= s.evidence_over_control * tip.control_evidence &&
         tip.loss >= s.loss_min;
}

DepthJudgement judge_depth(const DepthReading& reading, const DepthCheckSettings& s) {
  using enum DepthVerdict;
  const auto& [motion, tip] = reading;
  const double depth = tip.depth_mm - s.tip_offset.value;
  const bool changed = needle_seen(tip, s);
  const bool would_show = tip.visible >= std::max(s.evidence_min, s.evidence_over_control * tip.control_evidence);
  if (!motion.within_limits)
    return {Unsure, fmt::format("The patient seems to have moved by {:.1f} mm: too far to compare the images. Plan anew.",
                                motion.shift_mm.norm())};
  if (motion.score < s.registration_min)
    return {Unsure, fmt::format("The images do not match well enough to compare (correlation {:.2f}, needed {:.2f}).",
                                motion.score, s.registration_min)};
  if (!changed && !would_show)
    return {Unsure, "A needle could not be told from noise and motion along this path: contrast is too low."};
  if (!changed)
    return {Reject, fmt::format("No needle found: nothing along the path changed beyond chance (evidence {:.1f}, "
                                "beside the path {:.1f}).", tip.evidence, tip.control_evidence)};
  if (tip.at_end) return {Unsure, "The void goes on to where the images end: the tip is not in view."};
  if (tip.gap_mm > 0.0)
    return {Unsure, fmt::format("The void along the path is interrupted for {:.1f} mm: it may not be one needle.",
                                tip.gap_mm)};
  if (tip.rival_against < std::max(s.rival_against_min, tip.control_evidence))
    return {Unsure, fmt::format("Two ends of the void are nearly as likely: {:.1f} mm and {:.1f} mm.", depth,
                                tip.rival_depth_mm)};
  if (std::max(tip.depth_mm - tip.low_mm, tip.high_mm - tip.depth_mm) > s.range_max.value)
    return {Unsure, fmt::format("The tip may lie anywhere from {:.1f} to {:.1f} mm: the images differ as much beside the "
                                "path.", tip.low_mm - s.tip_offset.value, tip.high_mm - s.tip_offset.value)};
  if (tip.sigma_mm > s.sigma_max.value)
    return {Unsure, fmt::format("The tip is at about {:.1f} mm, but only known to {:.2f} mm (one standard deviation); "
                                "{:.2f} mm is needed.", depth, tip.sigma_mm, s.sigma_max.value)};
  if (!s.expected) return {Accept, fmt::format("Tip found {:.2f} mm from the entry, known to {:.2f} mm.", depth, tip.sigma_mm)};
  const double off = depth - s.expected->value;
  if (std::abs(off) <= s.tolerance.value)
    return {Accept, fmt::format("Tip found at {:.2f} mm, {:+.2f} mm from the planned {:.2f} mm.", depth, off,
                                s.expected->value)};
  if (std::abs(off) > s.tolerance.value + 2.0 * tip.sigma_mm)
    return {Reject, fmt::format("Tip found at {:.2f} mm, {:.2f} mm {} the planned {:.2f} mm.", depth, std::abs(off),
                                off > 0.0 ? "deeper than" : "short of", s.expected->value)};
  return {Unsure, fmt::format("Tip found at {:.2f} mm; whether it is within {:.2f} mm of the planned {:.2f} mm cannot "
                              "be told.", depth, s.tolerance.value, s.expected->value)};
}

}  // namespace biopsy::imaging
