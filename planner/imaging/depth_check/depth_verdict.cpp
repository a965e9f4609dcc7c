#include "planner/imaging/depth_check/depth_verdict.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "robot/common/text/number_text.hpp"

namespace biopsy::imaging {

namespace {

using enum DepthVerdict;
using MaybeJudgement = std::optional<DepthJudgement>;

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

double normal_cdf(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

// Probability that the tip lies within `band` of `expected`, both mm.
double depth_within(const TipFinding& tip, double expected, double band, const DepthCheckSettings& s) {
  const double offset = s.tip_offset->value.value, sigma = std::max(s.tip_offset->sigma.value, 1e-3);
  double within = 0.0;
  for (std::size_t n = 0; n < tip.depths_mm.size(); ++n) {
    const double off = tip.depths_mm[n] - offset - expected;
    within += tip.weights[n] * (normal_cdf((band - off) / sigma) - normal_cdf((-band - off) / sigma));
  }
  return within;
}

// The likeliest depth of the void's end.
double likeliest_depth(const TipFinding& tip) {
  const auto most = std::max_element(tip.weights.begin(), tip.weights.end());
  return most == tip.weights.end() ? tip.depth_mm
                                   : tip.depths_mm[static_cast<std::size_t>(most - tip.weights.begin())];
}

// Probability that a place is within `radius` of the axis; its errors are normal. Summed over a disc.
double within_disc(const Planar& place, double radius) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(place.covariance);
  if (axes.info() != Eigen::Success || !place.value.allFinite()) return 0.0;
  const Eigen::Vector2d sigma = axes.eigenvalues().cwiseMax(1e-12).cwiseSqrt();
  const Eigen::Vector2d centre = axes.eigenvectors().transpose() * place.value;
  constexpr int kStrips = 400;  // across the first axis; the second is integrated exactly
  double within = 0.0;
  for (int n = 0; n < kStrips; ++n) {
    const double low = -radius + 2.0 * radius * n / kStrips, high = low + 2.0 * radius / kStrips;
    const double half = std::sqrt(std::max(radius * radius - 0.25 * (low + high) * (low + high), 0.0));
    within += (normal_cdf((high - centre.x()) / sigma.x()) - normal_cdf((low - centre.x()) / sigma.x())) *
              (normal_cdf((half - centre.y()) / sigma.y()) - normal_cdf((-half - centre.y()) / sigma.y()));
  }
  return within;
}

// Wherever of the two it is.
double certainly_within(const Planar& place, double radius) {
  return std::min(within_disc(place, radius), within_disc(place.elsewhere(), radius));
}

double length_sigma_here(const Planar& place) {
  const double length = place.value.norm();
  if (length < 1e-9) return std::sqrt(0.5 * place.covariance.trace());
  const Eigen::Vector2d towards = place.value / length;
  return std::sqrt(std::max(towards.dot(place.covariance * towards), 0.0));
}

double length_sigma(const Planar& place) {
  return std::hypot(length_sigma_here(place), place.other.norm());
}

// Can these two images be compared at all?
MaybeJudgement doubt_about(const RegistrationResult& motion, const DepthCheckSettings& s) {
  if (motion.points == 0)
    return DepthJudgement{Unsure, "The images have too little in common around the path to compare them."};
  if (!motion.within_limits)
    return DepthJudgement{
        Unsure, fmt::format("The patient seems to have moved by {:.1f} mm: too far to compare the images. "
                            "Plan anew.",
                            motion.shift_mm.norm())};
  if (!(motion.score >= s.registration_min))
    return DepthJudgement{
        Unsure, fmt::format("The images do not match well enough to compare (correlation {:.2f}, needed "
                            "{:.2f}).",
                            motion.score, s.registration_min)};
  return std::nullopt;
}

// Is there a needle?
MaybeJudgement absence(const TipFinding& tip, const DepthCheckSettings& s) {
  if (needle_seen(tip, s)) return std::nullopt;
  if (tip.loss > 0.0 && tip.control_places == 0)
    return DepthJudgement{
        Unsure, "Too little of the images lies around the path to measure how far off a reading is."};
  const double lost_at_most = tip.loss + 2.0 * tip.loss_sigma;
  if (!(tip.visible >= s.evidence_min && lost_at_most < s.needle_loss))
    return DepthJudgement{Unsure,
                          "A needle could not be told from noise and motion along this path: contrast is too "
                          "low."};
  return DepthJudgement{
      Reject, fmt::format("No needle found: along the path {:.0f} % of the signal is lost at most; a "
                          "needle would take {:.0f} %.",
                          100.0 * lost_at_most, 100.0 * s.needle_loss)};
}

// A quantity that is hardly known is within no narrow tolerance by much of its probability: what is asked is
// how much less likely it is to be there than it could be at best, were it as little known.
bool certainly_beyond(double within, double within_at_best, const DepthCheckSettings& s) {
  return within < (1.0 - s.missed_certainly) * within_at_best;
}

// Of two places that explain the images alike, all that lies between is possible as well.
bool certainly_beyond(const Planar& place, double tolerance, const DepthCheckSettings& s) {
  const Planar spread{place.value, place.covariance + place.other * place.other.transpose()};
  const Planar on_axis{Eigen::Vector2d::Zero(), spread.covariance};
  return certainly_beyond(within_disc(spread, tolerance), within_disc(on_axis, tolerance), s);
}

// Whether the place beside the axis is known so well that it could be accepted, were it on the axis. Where it
// is not, as across one thick slice, a void may end where the needle leaves the slice: that is no depth.
bool place_known(const Planar& place, const DepthCheckSettings& s) {
  const Planar on_axis{Eigen::Vector2d::Zero(), place.covariance + place.other * place.other.transpose()};
  return within_disc(on_axis, s.lateral_mm.limit) >= s.confidence;
}

// The largest distance from the axis that the needle certainly exceeds.
double certainly_beside_mm(const Planar& place, const DepthCheckSettings& s) {
  double low = s.lateral_mm.tolerance, high = place.value.norm() + place.other.norm();
  for (int n = 0; n < 20; ++n) {
    const double middle = 0.5 * (low + high);
    (certainly_beyond(place, middle, s) ? low : high) = middle;
  }
  return low;
}

// A quantity of the needle that certainly misses its tolerance.
MaybeJudgement miss(const TipFinding& tip, const NeedlePlacement& read, const DepthCheckSettings& s) {
  if (certainly_beyond(tip.beside_mm, s.lateral_mm.tolerance, s))
    return DepthJudgement{
        Reject,
        fmt::format("The needle lies {:.1f} mm (+-{:.1f}) beside the planned axis, certainly more than "
                    "{:.1f} mm; {:.1f} mm are allowed.",
                    read.lateral_mm, read.lateral_sigma_mm, certainly_beside_mm(tip.beside_mm, s),
                    s.lateral_mm.tolerance)};
  if (certainly_beyond(tip.slope, std::tan(s.angle_deg.tolerance / kDegreesPerRadian), s))
    return DepthJudgement{Reject,
                          fmt::format("The needle is tilted by {:.1f} degrees (+-{:.1f}) against the planned "
                                      "axis; {:.1f} are allowed.",
                                      read.angle_deg, read.angle_sigma_deg, s.angle_deg.tolerance)};
  if (!s.expected || !s.tip_offset || !place_known(tip.beside_mm, s)) return std::nullopt;
  const double expected = s.expected->value;
  if (tip.at_end) {
    const double least = tip.seen_to_mm - s.tip_offset->value.value - 2.0 * read.depth_sigma_mm;
    if (least > expected + s.depth_mm.tolerance)
      return DepthJudgement{
          Reject, fmt::format("The void goes on to the end of the images, {:.1f} mm from the entry: "
                              "deeper than the planned {:.2f} mm.",
                              tip.seen_to_mm, expected)};
    return std::nullopt;
  }
  const double best = likeliest_depth(tip) - s.tip_offset->value.value;
  if (!certainly_beyond(depth_within(tip, expected, s.depth_mm.tolerance, s),
                        depth_within(tip, best, s.depth_mm.tolerance, s), s))
    return std::nullopt;
  const double off = read.depth_mm - expected;
  return DepthJudgement{
      Reject, fmt::format("Tip found at {:.2f} mm, {:.2f} mm {} the planned {:.2f} mm.", read.depth_mm,
                          std::abs(off), off > 0.0 ? "deeper than" : "short of", expected)};
}

// What keeps the needle's place from being certain.
MaybeJudgement doubt_about(const TipFinding& tip, const NeedlePlacement& read, const DepthCheckSettings& s) {
  if (tip.at_end)
    return DepthJudgement{Unsure,
                          fmt::format("The void goes on to the end of what both images show, {:.1f} mm from "
                                      "the entry: where the tip is cannot be seen.",
                                      tip.seen_to_mm)};
  if (tip.gap_mm > 0.0)
    return DepthJudgement{
        Unsure, fmt::format("The void along the path is interrupted for {:.1f} mm: it may not be one "
                            "needle.",
                            tip.gap_mm)};
  const double lateral = certainly_within(tip.beside_mm, s.lateral_mm.limit);
  if (!(read.lateral_mm <= s.lateral_mm.tolerance && lateral >= s.confidence))
    return DepthJudgement{
        Unsure, fmt::format("The needle is read {:.1f} mm (+-{:.1f}) beside the planned axis; that it "
                            "is within {:.1f} mm is not certain.",
                            read.lateral_mm, read.lateral_sigma_mm, s.lateral_mm.limit)};
  const double angle = certainly_within(tip.slope, std::tan(s.angle_deg.limit / kDegreesPerRadian));
  if (!(read.angle_deg <= s.angle_deg.tolerance && angle >= s.confidence))
    return DepthJudgement{Unsure,
                          fmt::format("The needle's angle to the planned axis is read as {:.1f} degrees "
                                      "(+-{:.1f}); that it is within {:.1f} degrees is not certain.",
                                      read.angle_deg, read.angle_sigma_deg, s.angle_deg.limit)};
  if (!s.tip_offset)
    return DepthJudgement{
        Unsure, fmt::format("The void ends at {:.2f} mm, but how far it goes on beyond the tip has not "
                            "been calibrated for this needle and sequence.",
                            read.depth_mm)};
  const double centre = s.expected ? s.expected->value : read.depth_mm;
  const double depth = depth_within(tip, centre, s.depth_mm.limit, s);
  if (!(std::abs(read.depth_mm - centre) <= s.depth_mm.tolerance && depth >= s.confidence))
    return DepthJudgement{
        Unsure, fmt::format("The tip is read at {:.2f} mm (+-{:.2f}); that it is within {:.1f} mm of {} "
                            "{:.2f} mm is not certain.",
                            read.depth_mm, read.depth_sigma_mm, s.depth_mm.limit,
                            s.expected ? "the planned" : "the read", centre)};
  return std::nullopt;
}

DepthJudgement accepted(const NeedlePlacement& read, const DepthCheckSettings& s) {
  const std::string beside = fmt::format("{:.1f} mm beside the planned axis, tilted by {:.1f} degrees",
                                         read.lateral_mm, read.angle_deg);
  if (!s.expected)
    return {Accept, fmt::format("Tip found {:.2f} mm from the entry, known to {:.2f} mm; {}.", read.depth_mm,
                                read.depth_sigma_mm, beside)};
  return {Accept,
          fmt::format("Tip found at {:.2f} mm, {:+.2f} mm from the planned {:.2f} mm; {}.", read.depth_mm,
                      rounded(read.depth_mm - s.expected->value, 2), s.expected->value, beside)};
}

}  // namespace

NeedlePlacement placement_of(const TipFinding& tip, const DepthCheckSettings& s) {
  const double offset = s.tip_offset ? s.tip_offset->value.value : 0.0;
  const double offset_sigma = s.tip_offset ? s.tip_offset->sigma.value : 0.0;
  const double slope = tip.slope.value.norm();
  return {tip.depth_mm - offset,
          std::hypot(tip.sigma_mm, offset_sigma),
          tip.beside_mm.value.norm(),
          length_sigma(tip.beside_mm),
          std::atan(slope) * kDegreesPerRadian,
          length_sigma(tip.slope) * kDegreesPerRadian / (1.0 + slope * slope)};
}

bool needle_seen(const TipFinding& tip, const DepthCheckSettings& s) {
  return tip.evidence >= s.evidence_min && tip.loss >= s.loss_min && tip.control_places > 0;
}

DepthJudgement judge_depth(const DepthReading& reading, const DepthCheckSettings& settings) {
  const auto& [motion, tip] = reading;
  if (const auto doubt = doubt_about(motion, settings)) return *doubt;
  if (const auto absent = absence(tip, settings)) return *absent;
  const NeedlePlacement read = placement_of(tip, settings);
  DepthJudgement judgement;
  if (const auto missed = miss(tip, read, settings))
    judgement = *missed;
  else if (const auto doubt = doubt_about(tip, read, settings))
    judgement = *doubt;
  else
    judgement = accepted(read, settings);
  const double moved_mm = motion.shift_mm.norm();
  constexpr double kWorthTelling_mm =
      1.0;  // the depth is the robot's; where the tissue went, a person must weigh
  if (moved_mm > kWorthTelling_mm)
    judgement.reason +=
        fmt::format(" The patient moved {:.1f} mm at the entry since the image before.", moved_mm);
  return judgement;
}

}  // namespace biopsy::imaging
