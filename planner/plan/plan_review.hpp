// Review of a plan by a person who did not make it, and who does not trust the program that did: what is in
// it, and what cannot be seen by reading its numbers.
#pragma once

#include <optional>
#include <string>

#include "robot/msg/plan.hpp"

namespace biopsy::planner {

// Larger is a plan to an entry that is not where the needle waits: by so much the needle may go further than
// from entry to target while both stand where they were chosen. The depth check accepts no larger error.
inline constexpr Millimetres kReviewedEntry{0.5};

// What the plan does and is bound to, one fact a line, points as R, A, S; of its plausible depths the first
// and the last. Text from elsewhere is cut to 64 bytes, the longest identifier that DICOM has, without
// control or invisible characters. What a person is to compare stands at the end, where a terminal shows it.
std::string review_text(const Plan& plan);

// What the plan says and its own points deny (to 0.01 mm), and what is out of the planner's ranges: the
// needle elsewhere than at the entry, a transform that is not rigid, registration errors, speeds, dwell
// times, gains, limits, layers, steps that do not rise to the target. Nothing where it is in order. Where
// steps should end and which speed and voltage each should have is not computed anew: they are shown.
// Registration is the word of whoever sent the plan: this cannot be seen here.
std::optional<std::string> objection_to(const Plan& plan);

}  // namespace biopsy::planner
