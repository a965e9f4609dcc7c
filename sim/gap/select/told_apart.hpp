// Whether held-out runs tell two explanations apart that both leave next to nothing but noise. Log evidence
// counts one reading every two seconds, for errors of a wrong model repeat; where only noise is left, every
// reading counts whose error is its own.
#pragma once

#include "sim/gap/select/select.hpp"

namespace biopsy::sim::gap {

// By how much `a` predicts the held-out runs better than `b`, in log evidence, each reading counted. 0 unless
// `a` leaves about the noise, and the difference stands out of the noise and is more than integrators differ
// by.
double paired_evidence(const ScoredModel& a, const ScoredModel& b, const Evidence& evidence);

}  // namespace biopsy::sim::gap
