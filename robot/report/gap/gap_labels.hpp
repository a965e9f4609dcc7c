// What people read for the names that a GapFinding carries, and its numbers in readable units.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/gap/gap_finding.hpp"

namespace biopsy::report {

std::string_view label(GapVerdict verdict);        // as in gap.json: "no_gap"
std::string_view badge_label(GapVerdict verdict);  // for people: "✓ No gap"

std::string readable_name(std::string_view name);  // "coulomb_friction" -> "Coulomb friction"
// The same, but what a letter of the baseline stands for: "c_s" -> "viscous damping of the slider".
std::string explanation_label(std::string_view name);
// "after_reversal" -> "after a polarity reversal"; of the motion where a force drives.
std::string regime_label(std::string_view name, bool force_drive = false);
std::string candidate_label(const GapCandidate& candidate);

// In reading order: by round; in it the chosen one, then the fitted ones by probability and held-out RMSE,
// then the others by score.
std::vector<GapCandidate> ranked_candidates(std::vector<GapCandidate> candidates);

// A parameter's label, the unit in which people read it, and how many of that unit are one unit of the file.
struct ReadableQuantity {
  std::string label, unit;
  double per_file_unit = 1.0;
};
ReadableQuantity effect_quantity(std::string_view name);    // "speed_mm_s" -> speed, mm/s
ReadableQuantity baseline_quantity(std::string_view name);  // "d_film" (m) -> film thickness, um

// "0.0300 ± 0.0010": as many digits as the standard deviation allows, three where there is none.
std::string estimate_text(double value, double std);
// "0.0280 to 0.0320": value -+ 1.96 standard deviations; an en dash where there is none.
std::string interval_text(double value, double std);

// "F = -1.2e+04 v^3 + 0.4 x v": a proposed term with its numbers, N, up, in SI.
std::string equation_text(const ProposedTerm& term);

// Decimals that show `smallest` with two digits, 2 to 5 of them; for lengths in mm that stand side by side.
int decimals_for(double smallest);
std::string percent_text(double share);  // "62 %"

}  // namespace biopsy::report
