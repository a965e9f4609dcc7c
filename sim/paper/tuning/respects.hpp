// In which respects one controller is better or worse than another.
#pragma once

#include <string>
#include <vector>

#include "sim/paper/tuning/tune.hpp"

namespace biopsy::sim::tuning {

struct Respect {
  std::string name;   // "settling on the model"
  double gain = 0.0;  // share by which the other is better than the first; below 0: worse
};

// A larger change counts as one that a person would see.
inline constexpr double kNoticed = 0.05;

// Errors, overshoot and times on the model and on the worst stage, and the worst margins. Without the highest
// drive, which is no aim.
std::vector<Respect> respects(const EvaluatedGains& first, const EvaluatedGains& other);

// Better in at least one respect by more than kNoticed, and in none worse by more.
bool improves(const std::vector<Respect>& all);

// "better: settling on the model (12 %); worse: none", of what is noticed.
std::string comparison_text(const std::vector<Respect>& all);

}  // namespace biopsy::sim::tuning
