// Where calibrations of these tests start.
#pragma once

#include "sim/paper/paper_model.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim::calibration {

inline const std::filesystem::path kModels = source_dir() / "sim/models";

inline paper::PaperModel start_model() {
  return paper::read_paper_model(kModels / "rehearsal.toml", kModels / "paper.toml");
}

}  // namespace biopsy::sim::calibration
