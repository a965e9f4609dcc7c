// Whether what was selected may be given a name. A wrong name is worse than none: each objection is one
// reason why the effect that explains most is not what is missing, as a clause for a sentence.
#pragma once

#include <string>
#include <vector>

#include "sim/gap/select/select.hpp"

namespace biopsy::sim::gap {

// Of the whole remaining gap: closed to within the noise, or nearly. Otherwise a name is partial.
bool is_whole(const Selection& selection, const Evidence& evidence);

// Empty where the name stands. It needs: more than half of the gap closed; parameters known to better than
// themselves, and not the opposite of what the name says; the same with training and held-out runs exchanged;
// and, where the gap is not wholly closed, less left than by any smooth function of speed, position, input or
// time. Standard deviations must be estimated.
std::vector<std::string> objections(const Selection& selection, const Evidence& coarse, const Evidence& fine);

// Whether other numbers of the baseline are all that is missing. Not where quite different numbers follow the
// record as well; nor where a curve explains most of what they
// leave: a spring that softens with time is no spring of another stiffness, though that closes most of the
// gap.
std::vector<std::string> objections_to_numbers(const Selection& selection, const Evidence& coarse);

}  // namespace biopsy::sim::gap
