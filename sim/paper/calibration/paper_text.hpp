// Writes sim/models/paper.toml: the films and mechanisms that read_paper_model reads, with how well they are
// known.
#pragma once

#include <string>

#include "sim/paper/paper_model.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::sim::calibration {

// Notes by "film.pi25.tau" and "joint.mass_g"; values without one are written with the source they have in
// the paper or in model.md.
std::string paper_toml(const paper::PaperModel& model, const ModelNotes& notes);

}  // namespace biopsy::sim::calibration
