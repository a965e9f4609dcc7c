// Start values of a search for an effect: a few shapes, places, levels and frequencies, from the library's
// typical values and the range of the data.
#pragma once

#include <vector>

#include "sim/gap/fit/unknowns.hpp"

namespace biopsy::sim::gap {

struct Spectrum {
  std::vector<double> peaks;  // Hz, the strongest first
};

// Peaks of the training residual's periodogram, the runs' powers added (their phases need not agree).
Spectrum residual_spectrum(const std::vector<double>& training_residual, const Evidence& evidence);

// Whether the effect acts with this drive.
bool acts_on(const LibraryEffect& effect, Drive drive);

// Whether the effect ends for good at some point of a run, so that its cost has many minima.
bool gives_way(const LibraryEffect& effect);

// Whether the effect is another where its strength is negative, and not the opposite one.
bool turns_with_sign(const LibraryEffect& effect);

// Parameter vectors to try. SI
std::vector<std::vector<double>> probe_starts(int effect, const Evidence& evidence, const Spectrum& spectrum);

}  // namespace biopsy::sim::gap
