// One round of biopsy characterise --until-named.
#pragma once

#include <string>

namespace biopsy::robot {

struct NamingRound {
  std::string experiment;  // recorded before the comparison
  std::string verdict;     // of all that is recorded so far, as in gap.json
  std::string effect;      // the strongest; empty without one
  double probability = 0.0;
  double gap_closed = 0.0;
  std::string decision;  // a sentence: what follows from it, and why
};

}  // namespace biopsy::robot
