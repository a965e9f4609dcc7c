// What the paper's stage may have that the calibrated one lacks: hypotheses for the rows of the paper that
// are missed.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sim/paper/calibration/parameters.hpp"

namespace biopsy::sim::missing {

struct Candidate {
  std::string name;                              // as in files and in JSON: "zipping_play"
  std::string meaning;                           // in plain words
  std::vector<calibration::Parameter> unknowns;  // beside those of the calibration; absent at their nominal
  std::vector<std::pair<std::string, double>> set = {};  // values that it changes and that are not searched
};

// Effects of the library that the calibrated stage does not have, and what the text leaves open of the
// set-up.
const std::vector<Candidate>& paper_candidates();

// Those of these names, in the order of the list; all where no name is given. Throws ConfigError for a name
// that is not in it.
std::vector<Candidate> paper_candidates(const std::vector<std::string>& names);

}  // namespace biopsy::sim::missing
