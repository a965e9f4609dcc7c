// Data sets with something hidden in them, and how far the hidden thing stands above the noise.
#pragma once

#include <filesystem>
#include <string>

#include "sim/plant/dataset.hpp"
#include "tests/sim/gap/generator/hidden_cases.hpp"

namespace biopsy::hidden {

sim::Dataset make_hidden(const HiddenCase& hidden);
// The same programs and errors of the baseline with this physics.
sim::Dataset make_hidden(const HiddenCase& hidden, const HiddenPhysics& physics);

// mm, root mean square over all rows, without noise: with the hidden terms against without them, parameters
// alike (Parameter and Nothing: true parameters against nominal ones). `only`: that term alone against its
// absence.
double effect_rms(const HiddenCase& hidden, const std::string& only = "");

// mm: what is left of it when the seven (force: three) erring parameters may change, to first order. A
// workflow that frees them has no more than this to go by.
double identifiable_rms(const HiddenCase& hidden, const std::string& only = "");

// mm: what the small parameter errors alone do.
double parameter_rms(const HiddenCase& hidden);

// The model the workflow starts from: the nominal baseline, nothing else. TOML.
std::string baseline_model(const HiddenCase& hidden);

// dataset.toml, the runs and model.toml; without the answer. Creates the folder.
void write_hidden(const HiddenCase& hidden, const std::filesystem::path& folder);

}  // namespace biopsy::hidden
