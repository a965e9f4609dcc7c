#include "planner/imaging/depth_check/depth_verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/text/number_text.hpp"

namespace biopsy::imaging {

namespace {

using enum DepthVerdict;
using fmt::format;

// Can these two images be compared at all?
std::optional<DepthJudgement> doubt_about(const RegistrationResult& motion, const DepthCheckSettings& s) {
  if (motion.points == 0)
    return DepthJudgement{Unsure, "The images have too little in common around the path to compare them."};
  if (!motion.within_limits)
    return DepthJudgement{
        Unsure, format("The patient seems to have moved by {:.1f} mm: too far to compare the images. "
                       "Plan anew.",
                       motion.shift_mm.norm())};
  if (!(motion.score >= s.registration_min))
    return DepthJudgement{Unsure,
                          format("The images do not match well enough to compare (correlation {:.2f}, needed "
                                 "{:.2f}).",
                                 motion.score, s.registration_min)};
  return std::nullopt;
}

// Is there a needle?
std::optional<DepthJudgement> absence(const TipFinding& tip, const DepthCheckSettings& s) {
  if (needle_seen(tip, s)) return std::nullopt;
  const bool would_show =
      tip.visible >= std::max(s.evidence_min, s.evidence_over_control * tip.control_evidence);
  if (!would_show)
    return DepthJudgement{Unsure,
                          "A needle could not be told from noise and motion along this path: contrast is too "
                          "low."};
  return DepthJudgement{Reject,
                        format("No needle found: nothing along the path changed beyond chance (evidence "
                               "{:.1f}, beside the path {:.1f}).",
                               tip.evidence, tip.control_evidence)};
}

// Is it certain where it ends?
std::optional<DepthJudgement> doubt_about(const TipFinding& tip, double depth, const DepthCheckSettings& s) {
  const double low = tip.low_mm - s.tip_offset.value, high = tip.high_mm - s.tip_offset.value;
  if (tip.at_end)
    return DepthJudgement{Unsure, "The void goes on to where the images end: the tip is not in view."};
  if (tip.gap_mm > 0.0)
    return DepthJudgement{Unsure,
                          format("The void along the path is interrupted for {:.1f} mm: it may not be one "
                                 "needle.",
                                 tip.gap_mm)};
  if (tip.rival_against < std::max(s.rival_against_min, tip.control_evidence))
    return DepthJudgement{Unsure,
                          format("Two ends of the void are nearly as likely: {:.1f} mm and {:.1f} mm.", depth,
                                 tip.rival_depth_mm - s.tip_offset.value)};
  if (!(tip.darkest >= s.darkest_min))
    return DepthJudgement{
        Unsure, format("The tip is at about {:.1f} mm, but the image before is dark there already (a "
                       "bubble, an old track or air): it could hide the tip.",
                       depth)};
  if (!(std::max(depth - low, high - depth) <= s.range_max.value))
    return DepthJudgement{
        Unsure, format("The tip may lie anywhere from {:.1f} to {:.1f} mm: the images differ as much "
                       "beside the path.",
                       low, high)};
  if (!(tip.sigma_mm <= s.sigma_max.value))
    return DepthJudgement{Unsure,
                          format("The tip is at about {:.1f} mm, but only known to {:.2f} mm (one standard "
                                 "deviation); {:.2f} mm is needed.",
                                 depth, tip.sigma_mm, s.sigma_max.value)};
  return std::nullopt;
}

DepthJudgement against_plan(double depth, double sigma_mm, const DepthCheckSettings& s) {
  if (!s.expected)
    return {Accept, format("Tip found {:.2f} mm from the entry, known to {:.2f} mm.", depth, sigma_mm)};
  const double off = depth - s.expected->value;
  if (std::abs(off) <= s.tolerance.value)
    return {Accept, format("Tip found at {:.2f} mm, {:+.2f} mm from the planned {:.2f} mm.", depth,
                           rounded(off, 2), s.expected->value)};
  if (std::abs(off) > s.tolerance.value + 2.0 * sigma_mm)
    return {Reject, format("Tip found at {:.2f} mm, {:.2f} mm {} the planned {:.2f} mm.", depth,
                           std::abs(off), off > 0.0 ? "deeper than" : "short of", s.expected->value)};
  return {Unsure,
          format("Tip found at {:.2f} mm; whether it is within {:.2f} mm of the planned {:.2f} mm cannot be "
                 "told.",
                 depth, s.tolerance.value, s.expected->value)};
}

}  // namespace

bool needle_seen(const TipFinding& tip, const DepthCheckSettings& s) {
  return tip.evidence >= s.evidence_min && tip.evidence >= s.evidence_over_control * tip.control_evidence &&
         tip.loss >= s.loss_min;
}

DepthJudgement judge_depth(const DepthReading& reading, const DepthCheckSettings& settings) {
  const auto& [motion, tip] = reading;
  const double depth = tip.depth_mm - settings.tip_offset.value;
  if (const auto doubt = doubt_about(motion, settings)) return *doubt;
  if (const auto absent = absence(tip, settings)) return *absent;
  if (const auto doubt = doubt_about(tip, depth, settings)) return *doubt;
  DepthJudgement judgement = against_plan(depth, tip.sigma_mm, settings);
  const double moved_mm = motion.shift_mm.norm();
  constexpr double kWorthTelling_mm =
      1.0;  // the depth is the robot's; where the tissue went, a person must weigh
  if (moved_mm > kWorthTelling_mm)
    judgement.reason += format(" The patient moved {:.1f} mm at the entry since the image before.", moved_mm);
  return judgement;
}

}  // namespace biopsy::imaging
