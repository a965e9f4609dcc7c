// What the paper's figures lack: each candidate as extra unknowns of the calibration, judged by the figures
// that it was not fitted to.
#pragma once

#include <cstddef>
#include <stop_token>
#include <string>
#include <vector>

#include "sim/paper/calibration/calibrate.hpp"
#include "sim/paper/missing/candidates.hpp"

namespace biopsy::sim::missing {

struct FoundValue {
  std::string name;    // with its unit, as in files
  double value = 0.0;  // fitted to all figures; of a value that is set, what it was set to
};

// Against the calibration without any candidate, by the same search from the same point.
struct Difference {
  std::size_t met = 0;                 // rows, with the candidate
  std::vector<std::string> won, lost;  // "9d 0.5 Hz: attenuated"

  int net() const { return static_cast<int>(won.size()) - static_cast<int>(lost.size()); }
};

struct CandidateResult {
  std::string name, meaning;
  std::vector<FoundValue> values;
  Difference fitted;    // to all figures at once
  Difference held_out;  // each figure by a calibration on the others
  double chance = 1.0;  // of winning as many of the held-out rows that changed, were each as likely lost
};

struct MissingSettings {
  int steps =
      6;  // of the calibration without a figure, from the nominal values: with Pull::Even and again robust
  int steps_with = 3;  // more of them with each candidate, and without any
  std::stop_token stop = {};
};

// Rows are those that are fitted.
struct MissingInPaper {
  std::vector<std::string> left_out;        // whole figures that were left out, one at a time
  std::vector<std::string> missed;          // rows without any candidate, fitted to all figures
  std::size_t rows = 0, rows_held_out = 0;  // of all figures, and of those that were left out
  std::size_t met = 0, met_held_out = 0;    // of them without any candidate
  std::vector<CandidateResult> candidates;  // most held-out rows won first, then most fitted rows
  int evaluations = 0;
  bool interrupted = false;  // candidates and figures that were not reached are missing
};

// Whether chance would give the best of as many candidates its held-out rows in less than one of twenty
// cases.
inline constexpr double kChance = 0.05;
inline bool is_named(const MissingInPaper& found, const CandidateResult& candidate) {
  return candidate.chance * static_cast<double>(found.candidates.size()) < kChance;
}

// Probability of at least `won` heads in won + lost throws of a coin. 1 where nothing changed.
double chance_of(std::size_t won, std::size_t lost);

// With all figures from the parameters' starts, the robust steps alone; without a figure from their nominal
// values, which do not know it. Whole figures with more missed rows first. Deterministic, on any number of
// cores.
MissingInPaper find_missing(const calibration::Question& question, const std::vector<Candidate>& candidates,
                            const MissingSettings& settings,
                            const calibration::CalibrationProgress& progress = {});

}  // namespace biopsy::sim::missing
