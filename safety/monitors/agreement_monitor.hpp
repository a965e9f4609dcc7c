// Two lasers measure the needle, each with electronics of its own. No single one can then show a depth that
// is not there: whatever shape its fault has (still, replayed, shifted, scaled, drifting, late, another
// surface), it departs from the other, or it is smaller than what the other allows.
#pragma once

#include <cstdint>

#include "robot/msg/fixed_messages.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/plan_facts.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::safety {

struct AgreementMonitor {
  HazardSet found = 0;                        // stands until the next measurement
  std::int32_t differ_score = 0;              // both valid, and further apart than kDiffer_um
  std::int32_t dropout_score = kDropoutTrip;  // of the second laser; nothing seen yet
};

// `fresh`: the measurement is a new one; an old one counts nothing. Without a patient there may be one laser.
HazardSet update(const PlanFacts& plan, AgreementMonitor& monitor, const Measurement& measured, bool fresh);

}  // namespace biopsy::safety
