// Of effects of which one contains another, the simpler name stands until the richer one shows itself.
#pragma once

#include "sim/gap/select/compare_candidates.hpp"

namespace biopsy::sim::gap {

inline constexpr double kBendSeen = 3.0;  // noises

// Of LuGre friction as a candidate: its bristles slip before readings show that they bend.
bool bends_unseen(const CandidateFit& fit, const Evidence& evidence);

// Stribeck friction, a hysteretic spring that yields at once and LuGre friction of stiff bristles contain
// Coulomb friction, so that they never fit worse: where that leaves little, they must be better beyond doubt,
// or Coulomb friction is the name. LuGre friction contains Stribeck friction as well, and gives way to either
// where readings do not show that its bristles bend.
// Stribeck friction that needs more force to keep sliding than to break away is the opposite of its name: it
// must be better beyond doubt where Coulomb friction leaves much.
void keep_simpler(Round& round, const Evidence& evidence);

}  // namespace biopsy::sim::gap
