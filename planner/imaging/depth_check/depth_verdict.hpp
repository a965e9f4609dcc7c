// From what was read off the images to a verdict and a sentence for a person.
#pragma once

#include <optional>
#include <string>

#include "planner/imaging/depth_check/find_tip.hpp"
#include "robot/msg/depth_check.hpp"
#include "robot/msg/tip_offset.hpp"

namespace biopsy::imaging {

// How the patient moved and where the void ends.
struct DepthReading {
  RegistrationResult motion;
  TipFinding tip;
};

// What is asked of one quantity: to be read within the tolerance, and within the limit with the confidence.
struct Allowance {
  double tolerance, limit;
};

struct DepthCheckSettings {
  std::optional<Millimetres> expected;  // planned depth; used for the verdict only, never to find the tip
  Millimetres depth_max{120.0};         // a prostate through the perineum is 60 to 100 mm deep
  std::optional<TipOffset> tip_offset;  // absent: nothing is accepted
  Allowance depth_mm{0.5, 1.0};         // read within half a pixel of 1 mm; 1 mm would harm
  Allowance lateral_mm{2.0, 3.0};       // needles bend and brackets sag by a couple of millimetres
  Allowance angle_deg{2.0, 4.0};
  double confidence = 0.95;        // that a quantity is within its limit
  double missed_certainly = 0.99;  // that a quantity is beyond its tolerance
  // Local contrast of registered images of one patient by one sequence correlates above 0.9, of a guidance
  // scan with a planning scan by 0.7 to 0.98; of two patients by 0.5 at most.
  double registration_min = 0.6;
  double evidence_min = 6.0;  // chance reaches 4.5 in the search of a whole corridor
  double loss_min = 0.25;     // less than this of the signal lost is no needle
  double needle_loss =
      0.6;  // what every needle takes away at least: where certainly less is lost, there is none
};

struct DepthJudgement {
  DepthVerdict verdict = DepthVerdict::Unsure;
  std::string reason;
};

// What was read of the needle, with standard deviations; the calibrated offset taken off.
struct NeedlePlacement {
  double depth_mm, depth_sigma_mm;
  double lateral_mm, lateral_sigma_mm;
  double angle_deg, angle_sigma_deg;
};
NeedlePlacement placement_of(const TipFinding& tip, const DepthCheckSettings& settings);

// A void that beats chance, beats the rest of the image and is dark enough: a needle is there, wherever it
// ends.
bool needle_seen(const TipFinding& tip, const DepthCheckSettings& settings);

// Worst news first: Reject where one quantity certainly misses, Accept where all three certainly hold.
DepthJudgement judge_depth(const DepthReading& reading, const DepthCheckSettings& settings);

}  // namespace biopsy::imaging
