// From what was read off the images to a verdict and a sentence for a person.
#pragma once

#include <optional>
#include <string>

#include "planner/imaging/depth_check/find_tip.hpp"
#include "robot/msg/depth_check.hpp"

namespace biopsy::imaging {

// How the patient moved and where the void ends.
struct DepthReading {
  RegistrationResult motion;
  TipFinding tip;
};

struct DepthCheckSettings {
  std::optional<Millimetres> expected;  // planned depth; used for the verdict only, never to find the tip
  Millimetres tolerance{0.5};           // accept within this of the plan: half of an in-plane pixel of 1 mm
  Millimetres depth_max{120.0};         // a prostate through the perineum is 60 to 100 mm deep
  Millimetres tip_offset{
      0.0};  // how far the void ends beyond the real tip, from a calibration of the sequence
  // A depth that is less certain is not accepted: three of these stay within the 1 mm that would harm.
  Millimetres sigma_max{0.30};
  Millimetres range_max{1.0};  // nor one that changes like those beside the path could have moved by this
  // Registered images of one patient by one sequence correlate above 0.9, a guidance scan with a planning
  // scan 0.8.
  double registration_min = 0.6;
  // The void must be larger than chance, and than the differences of the images beside the path.
  double evidence_min = 8.0, evidence_over_control = 2.0;
  double loss_min = 0.25;          // less than this of the signal lost is no needle
  double darkest_min = 0.25;       // darker than this beside the rest, a bubble may pass for the tip
  double rival_against_min = 5.0;  // evidence needed against any other tip; and more than beside the path
};

struct DepthJudgement {
  DepthVerdict verdict = DepthVerdict::Unsure;
  std::string reason;
};

// A void that beats chance, beats the rest of the image and is dark enough: a needle is there, wherever it
// ends.
bool needle_seen(const TipFinding& tip, const DepthCheckSettings& settings);

// Worst news first; Accept only when nothing contradicts it.
DepthJudgement judge_depth(const DepthReading& reading, const DepthCheckSettings& settings);

}  // namespace biopsy::imaging
