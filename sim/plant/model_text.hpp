// Writes model files so that reading gives back exactly the model and the notes that were written: numbers in
// the fewest digits that read back as the same double. Comments of an earlier file are not kept.
#pragma once

#include <string>
#include <string_view>

#include "sim/plant/model_file.hpp"

namespace biopsy::sim {

// [baseline] with every name (drive = "force": with those that act there, and those that differ from the
// reference), one [effect.NAME] per effect that is present and one [term.NAME] per term. Throws ConfigError
// for a model that could not be read back: a value out of its range or not finite, or a note on a value that
// the file does not hold.
std::string model_toml(const PlantModel& model, const ModelNotes& notes);

// `si` in units of `si_per_unit`, as the shortest number that reads back as exactly `si`. Where none does
// (about 2 % of arbitrary values), the nearest. Never outside [low, high] by rounding alone.
std::string number_in_unit(double si, double si_per_unit, double low, double high);

}  // namespace biopsy::sim
